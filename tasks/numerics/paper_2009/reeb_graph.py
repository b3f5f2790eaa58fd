"""Multiresolution Reeb graph of a function on a surface (2009, Sec. 2.1; Hilaga 2001, Sec. 3).

The range of μ is cut into 2^levels bands of equal height. A node is a connected piece of the surface in one band, an edge a
contour at which two pieces meet. Triangles are cut exactly at the bands' borders, so that pieces do not depend on the
tessellation. Pairs of bands make the bands of the next coarser level, whose nodes are unions of the finer ones that meet.
"""

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.compiled import compiled


class ReebGraph(NamedTuple):
    """All levels of one frame's Reeb graph; nodes of the finest level come first, then those of each coarser one.

    level    : (node,) 0 for the finest
    band     : (node,) number of its band on its level, from low μ to high
    parent   : (node,) node of the next coarser level that it is a part of, −1 on the coarsest
    area     : (node,) mesh unit²
    centre   : (node, xyz) centre of area, mesh unit
    edge     : (edge, 2) nodes of the finest level that meet, the lower band first
    contour  : (edge, xyz) middle of the contour between them, mesh unit
    of_vertex : (vertex,) the finest node that holds it, −1 for vertices in no face
    """

    level: Ints
    band: Ints
    parent: Ints
    area: Floats
    centre: Floats
    edge: Ints
    contour: Floats
    of_vertex: Ints


def reeb_graph(V: Floats, F: npt.NDArray[np.integer[Any]], mu: Floats, levels: int = 6) -> ReebGraph:
    """The Reeb graph of μ in 2^levels bands, and in half as many, down to a single one.

    V, F   : (vertex, xyz) mesh unit · (face, corner) at least one
    mu     : (vertex,) finite at all vertices with a face; any unit
    levels : how often the number of bands is halved
    """
    faces = np.ascontiguousarray(F, dtype=np.int64)
    count = 2**levels
    used = mu[faces]
    low, high = float(used.min()), float(used.max())
    scaled = (mu - low) * (count / max(high - low, np.finfo(float).tiny * count))
    height = np.where(np.isfinite(scaled), np.minimum(scaled, count), 0.0)
    first, piece = _joined(faces, np.ascontiguousarray(height), count)
    roots, piece = np.unique(piece, return_inverse=True)
    piece = piece.reshape(-1).astype(np.int64)
    P = np.ascontiguousarray(V, np.float64)
    area, moment, band, link, middle = _measured(P, faces, height, count, first, piece, len(roots))
    edge, contour = _edges(link, middle)
    of_vertex = np.full(len(V), -1)
    corner = np.minimum(height[faces].astype(np.int64), count - 1)
    lowest = np.minimum(height[faces].min(axis=1).astype(np.int64), count - 1)
    of_vertex[faces] = piece[first[:-1, None] + corner - lowest[:, None]]
    return _coarsened(band, area, moment, edge, contour, of_vertex, levels)


def active_nodes(graph: ReebGraph, level: int) -> Ints:
    """(finest node,) the node of a level that each finest node is a part of."""
    own = np.arange(int((graph.level == 0).sum()))
    for _ in range(level):
        own = graph.parent[own]
    return own


def _coarsened(
    band: Ints, area: Floats, moment: Floats, edge: Ints, contour: Floats, of_vertex: Ints, levels: int
) -> ReebGraph:
    """All levels from the finest one: two nodes are one where their bands are a pair and they meet."""
    levels_of, bands, areas, parents = [np.zeros(len(band), np.int64)], [band], [area], []
    moments, first, link = [moment], 0, edge
    for level in range(1, levels + 1):
        half = bands[-1] // 2
        inside = half[link[:, 0]] == half[link[:, 1]]
        label = _components(len(half), link[inside])
        count = int(label.max()) + 1
        here = np.zeros(count, np.int64)
        here[label] = half
        first += len(half)
        parents.append(first + label)
        levels_of.append(np.full(count, level))
        bands.append(here)
        areas.append(np.bincount(label, areas[-1], count).astype(np.float64))
        moments.append(np.stack([np.bincount(label, moments[-1][:, x], count) for x in range(3)], axis=1))
        link = np.unique(label[link[~inside]].reshape(-1, 2), axis=0)
    parents.append(np.full(len(bands[-1]), -1))
    sizes = np.concatenate(areas)
    return ReebGraph(
        level=np.concatenate(levels_of),
        band=np.concatenate(bands),
        parent=np.concatenate(parents),
        area=sizes,
        centre=np.concatenate(moments) / np.maximum(sizes, np.finfo(float).tiny)[:, None],
        edge=edge,
        contour=contour,
        of_vertex=of_vertex,
    )


def _components(count: int, link: Ints) -> Ints:
    """(node,) number of each node's component, in the order of first nodes."""
    parent = np.arange(count)
    _union(parent, np.ascontiguousarray(link, np.int64))
    return np.unique(parent, return_inverse=True)[1].reshape(-1).astype(np.int64)


def _edges(link: Ints, middle: Floats) -> tuple[Ints, Floats]:
    """(edge, 2) pairs of nodes that meet, each once · (edge, xyz) the middle of the contour, by length."""
    if not len(link):
        return np.zeros((0, 2), np.int64), np.zeros((0, 3))
    edge, row = np.unique(link, axis=0, return_inverse=True)
    row = row.reshape(-1)
    length = np.maximum(np.bincount(row, middle[:, 3], len(edge)), np.finfo(float).tiny)
    points = np.stack([np.bincount(row, middle[:, 3] * middle[:, x], len(edge)) for x in range(3)], axis=1)
    return edge.astype(np.int64), points / length[:, None]


@compiled
def _root(parent: Ints, v: int) -> int:
    while parent[v] != v:
        parent[v] = parent[parent[v]]
        v = parent[v]
    return v


@compiled
def _union(parent: Ints, link: Ints) -> None:
    """Joins the components of linked nodes; every node then has the least of its component as parent."""
    for e in range(len(link)):
        a, b = _root(parent, link[e, 0]), _root(parent, link[e, 1])
        if a != b:
            parent[max(a, b)] = min(a, b)
    for v in range(len(parent)):
        parent[v] = _root(parent, v)


@compiled
def _joined(F: Ints, height: Floats, count: int) -> tuple[Ints, Ints]:
    """(face + 1,) where the cells of each face begin, one for each band it reaches · (cell,) its component's first cell."""
    first = np.zeros(len(F) + 1, np.int64)
    low, high = np.empty(len(F), np.int64), np.empty(len(F), np.int64)
    for f in range(len(F)):
        a, b, c = height[F[f, 0]], height[F[f, 1]], height[F[f, 2]]
        low[f], high[f] = min(int(min(a, b, c)), count - 1), min(int(max(a, b, c)), count - 1)
        first[f + 1] = first[f] + high[f] - low[f] + 1
    parent = np.arange(first[-1])
    key = np.empty(3 * len(F), np.int64)
    for f in range(len(F)):
        for i in range(3):
            u, v = F[f, i], F[f, (i + 1) % 3]
            key[3 * f + i] = min(u, v) * len(height) + max(u, v)
    order = np.argsort(key)
    for k in range(1, len(order)):
        if key[order[k]] == key[order[k - 1]]:
            f, g = order[k] // 3, order[k - 1] // 3
            i = order[k] % 3
            a, b = height[F[f, i]], height[F[f, (i + 1) % 3]]
            for s in range(min(int(min(a, b)), count - 1), min(int(max(a, b)), count - 1) + 1):
                x, y = _root(parent, first[f] + s - low[f]), _root(parent, first[g] + s - low[g])
                if x != y:
                    parent[max(x, y)] = min(x, y)
    for c in range(len(parent)):
        parent[c] = _root(parent, c)
    return first, parent


@compiled
def _measured(
    V: Floats, F: Ints, height: Floats, count: int, first: Ints, piece: Ints, pieces: int
) -> tuple[Floats, Floats, Ints, Ints, Floats]:
    """(piece,) area · (piece, xyz) area times centre · (piece,) band · (crossing, 2) pieces · (crossing, 4) middle, length."""
    area, moment, band = np.zeros(pieces), np.zeros((pieces, 3)), np.zeros(pieces, np.int64)
    crossings = first[-1] - len(F)
    link, middle = np.empty((crossings, 2), np.int64), np.empty((crossings, 4))
    polygon, cut = np.empty((8, 4)), np.empty((8, 4))
    n = 0
    for f in range(len(F)):
        lowest = count
        for i in range(3):
            for x in range(3):
                polygon[i, x] = V[F[f, i], x]
            polygon[i, 3] = height[F[f, i]]
            lowest = min(lowest, min(int(polygon[i, 3]), count - 1))
        size = 3
        for c in range(first[f], first[f + 1]):
            s = lowest + c - first[f]
            band[piece[c]] = s
            if c + 1 == first[f + 1]:
                _add(polygon, size, area, moment, piece[c])
                break
            below, size = _split(polygon, size, s + 1.0, cut, middle[n])
            _add(cut, below, area, moment, piece[c])
            link[n, 0], link[n, 1] = piece[c], piece[c + 1]
            n += 1
    return area, moment, band, link, middle


@compiled
def _split(polygon: Floats, size: int, level: float, below: Floats, middle: Floats) -> tuple[int, int]:
    """Cuts a convex polygon (corner, [xyz, height]) in place at a height; what lies below is written to `below`."""
    above = np.empty((8, 4))
    points = np.empty((2, 3))
    n, m, p = 0, 0, 0
    for i in range(size):
        a, b = polygon[i], polygon[(i + 1) % size]
        if a[3] < level:
            below[n] = a
            n += 1
        else:
            above[m] = a
            m += 1
        if (a[3] < level) != (b[3] < level):
            share = (level - a[3]) / (b[3] - a[3])
            corner = a + share * (b - a)
            corner[3] = level
            below[n], above[m] = corner, corner
            n, m = n + 1, m + 1
            points[min(p, 1)] = corner[:3]
            p += 1
    polygon[:m] = above[:m]
    for x in range(3):
        middle[x] = (points[0, x] + points[1, x]) / 2 if p > 1 else polygon[0, x]
    middle[3] = np.sqrt(((points[0] - points[1]) ** 2).sum()) if p > 1 else 0.0
    return n, m


@compiled
def _add(polygon: Floats, size: int, area: Floats, moment: Floats, piece: int) -> None:
    """Adds the area and moment of a convex polygon to a piece."""
    for i in range(1, size - 1):
        u, v = polygon[i, :3] - polygon[0, :3], polygon[i + 1, :3] - polygon[0, :3]
        x, y, z = u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]
        a = np.sqrt(x * x + y * y + z * z) / 2
        area[piece] += a
        for k in range(3):
            moment[piece, k] += a * (polygon[0, k] + polygon[i, k] + polygon[i + 1, k]) / 3
