"""A triangle mesh prepared for many distance queries: ordered rings, half-edges and lengths (2014, §4)."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.arrays import Flags, Floats, Indices, Ints, Lengths
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.geometry.geodesic_graph import Links, visibility_links
from kinetree.tasks.numerics.geometry.morton_curve import morton_order
from kinetree.tasks.numerics.geometry.normals import vertex_areas
from kinetree.tasks.numerics.geometry.visibility import BORDER, NON_MANIFOLD


@dataclass(frozen=True)
class Surface:
    """What every source of one frame shares; half-edge 3f + i runs from corner i of face f to corner i + 1.

    Inside, vertices are renumbered along a space-filling curve so that neighbours lie close in memory, and lengths
    are float32: a tenth of a millionth of an edge, for half the memory traffic. `order` leads back.

    order       : (vertex,) input number of each renumbered vertex
    ring_start  : (vertex + 1,) where each vertex's ring begins; a closed ring repeats its first neighbour
    ring        : (entry,) 2 × neighbour + 1 if a face lies between it and the entry before
    ring_length : (entry,) distance to that neighbour, mesh unit
    ring_edge   : (entry,) that face's half-edge that leaves the ring's vertex
    apex        : (half-edge,) vertex opposite
    twin        : (half-edge,) the other face's half-edge; BORDER where there is none, NON_MANIFOLD at an edge of three or more
                  faces and where a one-sided surface closes: faces are turned to agree wherever they can
    length      : (half-edge,) mesh unit
    links       : the straight lines from vertex to vertex along which distance spreads
    area        : (vertex,) a third of the faces around, mesh unit², in the input's numbering
    centre      : (xyz,) the surface's centre of area, mesh unit
    position    : (vertex, xyz) the input's vertices
    edge        : mean edge length, mesh unit
    """

    order: Ints
    ring_start: Indices
    ring: Indices
    ring_length: Lengths
    ring_edge: Indices
    apex: Indices
    twin: Indices
    length: Lengths
    links: Links
    area: Floats
    centre: Floats
    position: Floats
    edge: float

    @classmethod
    def of(cls, V: Floats, F: npt.NDArray[np.integer[Any]]) -> "Surface":
        """Prepare a mesh; open borders, any number of components and edges of three or more faces are accepted.

        V : (vertex, xyz) finite, mesh unit
        F : (face, corner) three different vertices each; vertices in no face are allowed and reached by nothing
        """
        order, P, corners = _along_curve(V, F)
        corners, twin, edges = _agreeing(corners, len(P))
        tail, head, apex = corners.ravel(), corners[:, [1, 2, 0]].ravel(), corners[:, [2, 0, 1]].ravel()
        length = np.linalg.norm(P[head] - P[tail], axis=1)
        angle = _angles(length)
        corner = np.argsort(tail, kind="stable")
        start = np.concatenate([[0], np.cumsum(np.bincount(tail, minlength=len(P)))])
        ring_start, kind, edge = _rings(start, corner, twin)
        inside = kind > 0
        area = _areas(order, P, corners)
        free = np.zeros(len(P), np.uint8)
        free[tail[twin >= NON_MANIFOLD]] = free[head[twin >= NON_MANIFOLD]] = 1
        free[np.bincount(np.repeat(np.arange(len(P)), np.diff(ring_start)), ~inside, len(P)) > 1] = 1
        rings = (
            ring_start.astype(np.uint32),
            (2 * np.where(inside, apex[edge], head[edge]) + inside).astype(np.uint32),
            edge.astype(np.uint32),
            apex.astype(np.uint32),
            twin.astype(np.uint32),
            length.astype(np.float32),
            np.where(inside, length[_before(edge)], length[edge]).astype(np.float32),
        )
        ends, along = np.stack([tail[edges], head[edges]], axis=1).astype(np.uint32), length[edges].astype(np.float32)
        return cls(
            order=order,
            ring_start=rings[0],
            ring=rings[1],
            ring_length=rings[6],
            ring_edge=rings[2],
            apex=rings[3],
            twin=rings[4],
            length=rings[5],
            links=Links(*visibility_links(rings, angle, free), ends, along),
            area=area,
            centre=(area[:, None] * V).sum(axis=0) / max(area.sum(), np.finfo(float).tiny),
            position=np.ascontiguousarray(V, dtype=np.float64),
            edge=float(length.mean()) if len(length) else 1.0,
        )


def surface_areas(V: Floats, F: npt.NDArray[np.integer[Any]]) -> Floats:
    """(vertex,) the area of `Surface.of(V, F)` alone, to the last bit, in a tenth of the time; mesh unit²."""
    order, P, corners = _along_curve(V, F)
    return _areas(order, P, _agreeing(corners, len(P))[0])


def _along_curve(V: Floats, F: npt.NDArray[np.integer[Any]]) -> tuple[Ints, Floats, Ints]:
    """The vertices' order along a Morton curve · (vertex, xyz) · (face, corner) in it."""
    order = morton_order(V)
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    corners: Ints = rank[F].reshape(-1, 3)
    corners = corners[np.argsort(corners.min(axis=1, initial=len(V)), kind="stable")]
    return order, np.ascontiguousarray(V[order], dtype=np.float64), corners


def _areas(order: Ints, P: Floats, corners: Ints) -> Floats:
    """(vertex,) in the input's numbering."""
    area = np.zeros(len(P))
    area[order] = vertex_areas(P, corners)
    return area


def _before(edge: Ints) -> Ints:
    """The half-edge before each in the same face."""
    return np.where(edge % 3 == 0, edge + 2, edge - 1)


def _agreeing(corners: Ints, vertices: int) -> tuple[Ints, Ints, Ints]:
    """Faces turned until neighbours agree, (half-edge,) its twin as in `Surface`, and (edge,) a half-edge of each."""
    tail, head = corners.ravel(), corners[:, [1, 2, 0]].ravel()
    key = np.minimum(tail, head) * vertices + np.maximum(tail, head)
    by_edge = np.argsort(key, kind="stable")
    first = np.flatnonzero(np.diff(key[by_edge], prepend=-1) != 0)
    faces = np.diff(first, append=len(key))
    pair = first[faces == 2]
    a, b = by_edge[pair], by_edge[pair + 1]
    opposed = tail[a] == head[b]
    if not opposed.all():
        partner = np.full(len(tail), BORDER)
        partner[a], partner[b] = b, a
        turned = _turned(partner, tail)
        if turned.any():
            return _agreeing(np.where(turned[:, None], corners[:, [0, 2, 1]], corners), vertices)
    twin = np.full(len(tail), NON_MANIFOLD)
    twin[by_edge[first[faces == 1]]] = BORDER
    twin[a[opposed]], twin[b[opposed]] = b[opposed], a[opposed]
    return corners, twin, by_edge[first]


@compiled
def _turned(partner: Ints, tail: Ints) -> Flags:
    """(face,) which to turn, so that faces agree with the first of their component, at most one of each two neighbours."""
    turned = np.zeros(len(tail) // 3, np.bool_)
    known, waiting = np.zeros(len(turned), np.bool_), np.empty(len(turned), np.int64)
    for seed in range(len(turned)):
        count = 0
        if not known[seed]:
            known[seed], waiting[0], count = True, seed, 1
        while count > 0:
            count -= 1
            f = waiting[count]
            for h in range(3 * f, 3 * f + 3):
                t = partner[h]
                if t < NON_MANIFOLD and not known[t // 3]:
                    g = t // 3
                    known[g], turned[g], waiting[count] = True, turned[f] != (tail[h] == tail[t]), g
                    count += 1
    return turned


def _angles(length: Floats) -> Floats:
    """(half-edge,) the angle at its tail; 0 in a triangle without area or with impossible sides."""
    edge = np.arange(len(length))
    a, b, c = length, length[_before(edge)], length[_before(_before(edge))]
    with np.errstate(divide="ignore", invalid="ignore"):
        cosine = (a * a + b * b - c * c) / (2 * a * b)
    return np.arccos(np.clip(np.nan_to_num(cosine, nan=1.0), -1.0, 1.0))


@compiled
def _rings(start: Ints, corner: Ints, twin: Ints) -> tuple[Ints, npt.NDArray[np.uint8], Ints]:
    """Fans of faces around every vertex, in order: where each ring starts, whether an entry ends a face, its edge."""
    done = np.zeros(len(twin), np.uint8)
    ring_start = np.zeros(len(start), np.int64)
    kind = np.zeros(2 * len(twin), np.uint8)
    edge = np.zeros(2 * len(twin), np.int64)
    k = 0
    for v in range(len(start) - 1):
        # open fans begin at their free edge; what remains is closed and may begin anywhere
        for closed in range(2):
            for q in range(start[v], start[v + 1]):
                h = corner[q]
                if done[h] or (closed == 0 and twin[h] < NON_MANIFOLD):
                    continue
                edge[k] = h
                k += 1
                while h < NON_MANIFOLD and not done[h]:
                    done[h] = 1
                    kind[k] = 1
                    edge[k] = h
                    k += 1
                    h = twin[h + 2 if h % 3 == 0 else h - 1]
        ring_start[v + 1] = k
    return ring_start, kind[:k].copy(), edge[:k].copy()
