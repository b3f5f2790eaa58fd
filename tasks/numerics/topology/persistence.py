"""0-dimensional persistence of a function on a surface, and the loops that its level sets close (2014, §5.1: Morse theory).

Superlevel sets {f ≥ c} grow as c falls: a component is born at a maximum and dies at the saddle where it meets an older
one (the elder rule). Between two vertices f is linear, so saddles lie at vertices.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.geometry.edge_rings import edge_rings, entries_before


class Peaks(NamedTuple):
    """Maxima of a function and where their components end; highest persistence first, ties by vertex.

    vertex      : (peak,) the maximum
    saddle      : (peak,) vertex at which its component meets that of `into`; −1 if it is a whole component's highest
    into        : (peak,) row of the older peak; −1 if none
    persistence : (peak,) f(vertex) − f(saddle); for a whole component's highest, down to that component's minimum
    """

    vertex: Ints
    saddle: Ints
    into: Ints
    persistence: Floats


def superlevel_peaks(f: Floats, F: npt.NDArray[np.integer], least: float = 0.0) -> Peaks:
    """Maxima of f with their 0-dimensional persistence over superlevel sets, by union-find from the top down.

    Equal values are ordered by vertex number, the smaller one first; this makes pairs of persistence 0, which never count.

    f       : (vertex,) finite; vertices in no face are ignored
    F       : (face, corner)
    least   : only peaks whose persistence is at least this and above 0, in the unit of f
    returns : Peaks; a component on which f is constant has none
    """
    order = np.argsort(-f, kind="stable").astype(np.int64)
    peak, saddle, into, low = _merges(order, *neighbours(F, len(f)))
    persistence = f[peak] - f[np.where(saddle >= 0, saddle, low)]
    high = np.flatnonzero((persistence >= least) & (persistence > 0.0))
    high = high[np.lexsort((peak[high], -persistence[high]))]
    row = np.full(len(f), -1, dtype=np.int64)
    row[peak[high]] = np.arange(len(high))
    # an older peak always persists longer than the one that ends in it, so it was high too
    older = np.where(into[high] >= 0, row[into[high]], -1)
    return Peaks(peak[high], saddle[high], older, persistence[high])


def loop_counts(f: Floats, F: npt.NDArray[np.integer], levels: int = 200) -> Ints:
    """How many independent loops of the surface cross each level of f: the spectrum of its handles.

    By Mayer–Vietoris, b₀(level) − b₀(above) − b₀(below) + b₀(surface) is the rank of H₁(surface) → H₀(level). A bump adds
    one to the level and one to what lies above, so noise cancels however rough the surface is; a handle counts at all
    levels that it spans, and a small one spans few.

    f       : (vertex,) finite; vertices in no face are ignored
    F       : (face, corner)
    levels  : evenly spaced between min f and max f, both left out
    returns : (level,) from low to high; zeros where f is constant
    """
    used = f[in_faces(F, len(f))]
    if not len(used) or not used.max() > used.min():
        return np.zeros(levels, dtype=np.int64)
    low, high = float(used.min()), float(used.max())
    # the levels below each vertex: a vertex exactly on a level lies above it, for all three counts
    step = np.searchsorted(low + (high - low) * np.arange(1, levels + 1) / (levels + 1), f, side="right").astype(np.int64)
    start, ring = neighbours(F, len(f))
    above = _components(step, start, ring, levels)
    below = _components(levels - step, start, ring, levels)
    return _contours(*_face_edges(F, step), levels) - above[1:] - below[:0:-1] + above[0]


def loop_spans(counts: Ints) -> Floats:
    """How far loops reach: lengths of the runs of levels crossed by at least one loop, by at least two, and so on.

    counts  : (level,) see `loop_counts`
    returns : (loop,) shares of the range of f, longest first; a finger fused to its neighbour has little, a hand on the
              hip as much as the arm between them
    """
    spans: list[float] = []
    for k in range(1, int(counts.max(initial=0)) + 1):
        edges = np.flatnonzero(np.diff(np.concatenate([[False], counts >= k, [False]])))
        spans += list((edges[1::2] - edges[::2]) / len(counts))
    return np.array(sorted(spans, reverse=True))


def in_faces(F: npt.NDArray[np.integer], vertices: int) -> Flags:
    """(vertex,) whether a face (face, corner) has the vertex as a corner."""
    used = np.zeros(vertices, np.bool_)
    used[F] = True
    return used


def neighbours(F: npt.NDArray[np.integer], vertices: int) -> tuple[Ints, Ints]:
    """Neighbours of every vertex in one array: v's are ring[start[v] : start[v + 1]], repeated where faces share them.

    F       : (face, corner)
    returns : start (vertex + 1,), ring (entry,)
    """
    return _neighbours(np.ascontiguousarray(F, np.int64), vertices)


@compiled
def _neighbours(F: Ints, vertices: int) -> tuple[Ints, Ints]:
    """See `neighbours`; of each vertex in the order of the faces, what follows it in a face before what it follows."""
    start = entries_before(F, vertices)
    filled, ring = start[:-1].copy(), np.empty(start[-1], np.int64)
    for f in range(len(F)):
        for back in range(2):
            for i in range(3):
                a, b = F[f, i], F[f, (i + 1) % 3]
                tail, head = (b, a) if back else (a, b)
                ring[filled[tail]] = head
                filled[tail] += 1
    return start, ring


@compiled
def region_above(f: Floats, level: float, seed: int, start: Ints, ring: Ints) -> Ints:
    """Vertices connected to `seed` through vertices with f > level, the seed first.

    f           : (vertex,)
    start, ring : see `neighbours`
    returns     : (region vertex,) at least the seed
    """
    reached = np.zeros(len(f), np.bool_)
    region = np.empty(len(f), np.int64)
    region[0] = seed
    reached[seed] = True
    done, count = 0, 1
    while done < count:
        v = region[done]
        done += 1
        for q in range(start[v], start[v + 1]):
            u = ring[q]
            if not reached[u] and f[u] > level:
                reached[u] = True
                region[count] = u
                count += 1
    return region[:count].copy()


def _face_edges(F: npt.NDArray[np.integer], step: Ints) -> tuple[Ints, Ints, Ints]:
    """Edges of every face by number, and the first and last + 1 level that each edge crosses.

    returns : (face, corner) edge numbers, (edge,) first level, (edge,) end
    """
    faces = np.ascontiguousarray(F, np.int64)
    return _numbered_edges(faces, step, *edge_rings(faces, len(step))[:2])


@compiled
def _numbered_edges(F: Ints, step: Ints, start: Ints, ring: Ints) -> tuple[Ints, Ints, Ints]:
    """See `_face_edges`; edges are numbered by their lower vertex, then by the other."""
    number = np.empty(len(ring), np.int64)
    first, end = np.empty(len(ring) // 2, np.int64), np.empty(len(ring) // 2, np.int64)
    count = 0
    for v in range(len(start) - 1):
        for q in range(start[v], start[v + 1]):
            if ring[q] > v:
                number[q], first[count], end[count] = count, min(step[v], step[ring[q]]), max(step[v], step[ring[q]])
                count += 1
    edge = np.empty(F.shape, np.int64)
    for f in range(len(F)):
        for i in range(3):
            a, b = F[f, i], F[f, (i + 1) % 3]
            q = start[min(a, b)]
            while ring[q] != max(a, b):
                q += 1
            edge[f, i] = number[q]
    return edge, first, end


@compiled
def _root(parent: Ints, v: int) -> int:
    while parent[v] != v:
        parent[v] = parent[parent[v]]
        v = parent[v]
    return v


@compiled
def _merges(order: Ints, start: Ints, ring: Ints) -> tuple[Ints, Ints, Ints, Ints]:
    """Every peak in falling order, the vertex where it ends (−1: never), the older peak there, the last vertex it has."""
    n = len(order)
    parent = np.full(n, -1, np.int64)
    # of each component, named by its highest vertex
    row, last = np.full(n, -1, np.int64), np.full(n, -1, np.int64)
    rank = np.empty(n, np.int64)
    rank[order] = np.arange(n)
    peak, saddle, into = np.empty(n, np.int64), np.full(n, -1, np.int64), np.full(n, -1, np.int64)
    count = 0
    for v in order:
        if start[v] == start[v + 1]:
            continue
        parent[v] = v
        own = v
        for q in range(start[v], start[v + 1]):
            if parent[ring[q]] < 0:
                continue
            other = _root(parent, ring[q])
            if other == own:
                continue
            old, young = (own, other) if rank[own] < rank[other] else (other, own)
            if young != v:
                saddle[row[young]], into[row[young]] = v, old
            parent[young] = old
            own = old
        if own == v:
            peak[count], row[v] = v, count
            count += 1
        last[own] = v
    return peak[:count], saddle[:count], into[:count], last[peak[:count]]


@compiled
def _components(step: Ints, start: Ints, ring: Ints, levels: int) -> Ints:
    """(levels + 1,) components of the vertices with at least k levels below them, for k = 0 to `levels`."""
    n = len(step)
    parent = np.full(n, -1, np.int64)
    counts = np.zeros(levels + 1, np.int64)
    alive = 0
    k = levels
    for v in np.argsort(-step, kind="mergesort"):
        while k > step[v]:
            counts[k] = alive
            k -= 1
        if start[v] == start[v + 1]:
            continue
        parent[v] = v
        alive += 1
        for q in range(start[v], start[v + 1]):
            if parent[ring[q]] >= 0:
                a, b = _root(parent, v), _root(parent, ring[q])
                if a != b:
                    parent[b] = a
                    alive -= 1
    counts[: k + 1] = alive
    return counts


@compiled
def _contours(edges: Ints, first: Ints, end: Ints, levels: int) -> Ints:
    """(level,) components of each level set: crossings of edges, joined where a face has two of them."""
    offset = np.zeros(len(first) + 1, np.int64)
    counts = np.zeros(levels, np.int64)
    for e in range(len(first)):
        offset[e + 1] = offset[e] + end[e] - first[e]
        counts[first[e] : end[e]] += 1
    parent = np.arange(offset[-1])
    for f in range(len(edges)):
        for i in range(3):
            a, b = edges[f, i], edges[f, (i + 1) % 3]
            for k in range(max(first[a], first[b]), min(end[a], end[b])):
                x, y = _root(parent, offset[a] + k - first[a]), _root(parent, offset[b] + k - first[b])
                if x != y:
                    parent[y] = x
                    counts[k] -= 1
    return counts
