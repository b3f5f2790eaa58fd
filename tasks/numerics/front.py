"""A front that advances over a surface in narrow bands: Dijkstra's order without a heap (2014, Eq. 1: g).

Within a band all updates are minima of values computed beforehand: the order of vertices within it does not matter,
and the inner loops hardly branch, which is where a heap spends its time.
"""

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.bands import BANDS, IDLE, advance, enter, lower
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.light import light
from kinetree.tasks.numerics.surface import Surface
from kinetree.tasks.numerics.unfolding import (
    BASE,
    BLOCK,
    FROM_LEFT,
    FROM_RIGHT,
    NEAR,
    OTHER,
    REACH,
    RIM,
    ROWS,
    SIDE,
    SIGMA,
    Y,
    leave_first,
    leave_next,
    unfold_first,
    unfold_next,
)
from kinetree.tasks.numerics.windows import Plane, plane

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Lengths = npt.NDArray[np.float32]
Indices = npt.NDArray[np.uint32]
Codes = npt.NDArray[np.uint64]
Topology = tuple[Indices, Indices, Lengths, Lengths, Indices, Indices, Indices, Indices, Lengths, npt.NDArray[np.uint8]]

Room = tuple[
    Floats, Floats, Indices, Indices, Indices, Indices, Codes, Floats, Indices, Floats, Indices, Plane
]  # fmt: skip

BAND = 0.25  # of the mean edge: wider bands settle vertices before their distance is known, narrower ones cost time
OVERLAP = 2.0  # mean edges of them that are front already: from these all beyond is seen
UNFOLDINGS = 3  # triangles after the first: each more costs 5 % of time and gains 5 % of accuracy

_0, _1, _2, _3 = np.uint64(0), np.uint64(1), np.uint64(2), np.uint64(3)
_32, _LOW = np.uint64(32), np.uint64(0xFFFFFFFF)


def topology(surface: Surface) -> Topology:
    """The arrays of a surface that compiled propagation reads, in its order of arguments."""
    s = surface
    return (
        s.ring_start, s.ring, s.ring_length, s.ring_rim, s.ring_edge, s.apex, s.twin, s.opening, s.length, s.bends,
    )  # fmt: skip


@compiled
def workspace(vertices: int, entries: int) -> Room:
    """Memory for one propagation at a time; the first array is the distance in the surface's own numbering."""
    around = plane(vertices)
    return (
        around[0],
        around[1],
        np.empty(vertices, np.uint32),
        # a vertex enters a band once, or twice if it had to wait in the last one
        np.empty((BANDS, 2 * vertices + 2), np.uint32),
        np.zeros(BANDS, np.uint32),
        np.empty(2 * vertices + 2, np.uint32),
        np.empty((2, entries + 1), np.uint64),
        np.empty((3, entries + 1)),
        np.empty(entries + 1, np.uint32),
        np.empty(ROWS * BLOCK),
        np.empty((3, BLOCK + 1), np.uint32),
        around,
    )


@compiled
def propagate(mesh: Topology, source: np.uint64, edge: float, radius: float, room: Room, exact: float = 0.0) -> None:
    """Distances from one source into room[0]; the only state is `room`.

    source : vertex in the surface's own numbering
    edge   : the surface's mean edge, mesh unit
    radius : mesh unit; what is farther becomes infinite
    exact  : mean edges around the source in which distances are exact, unless light is lost there at a blind edge
    """
    start, ring, ring_length, ring_rim, ring_edge, apex, twin, opening, length, bends = mesh
    distance, bend, band, waiting, filled, front, codes, results, reached, W, small, around = room
    distance[:] = np.inf
    band[:] = IDLE
    filled[:] = 0
    per_band, least = 1.0 / (BAND * edge), 1e-9 * edge
    limit = min(exact * edge, radius)
    light(source, limit, BAND * edge, start, ring, ring_edge, bends, (apex, twin, length), around)
    settled, now, queued = enter(
        source, limit, (exact - OVERLAP) * edge, per_band, distance, bend, band, waiting, filled, around[-1]
    )
    while queued > _0 and now <= radius * per_band:
        size = advance(now, per_band, distance, band, waiting, filled, front)
        if size == _0:
            now += _1
            continue
        queued -= size
        pairs, edges = _meet(size, front, now / per_band, start, ring, ring_length, distance, codes, results)
        found = _0
        for first in range(_0, pairs, np.uint64(BLOCK)):
            count = min(np.uint64(BLOCK), pairs - first)
            _load(np.uint64(first), count, codes, start, ring, ring_length, ring_rim, distance, bend, W, small)
            unfold_first(count, W)
            found = _collect(count, small[1], W, found, reached, results)
            count = leave_first(count, small[0], ring_edge, opening, W, small[2])
            for _ in range(UNFOLDINGS):
                if count == _0:
                    break
                unfold_next(count, small[2], length, W)
                for i in range(count):
                    small[1, i] = apex[np.uint64(small[2, i]) >> _1]
                found = _collect(count, small[1], W, found, reached, results)
                count = leave_next(count, twin, W, small[2])
        queued += lower(
            found, reached, results[0], results[1], now, per_band, least, settled, distance, bend, band, waiting, filled
        )
        for i in range(edges):
            v = codes[1, i] >> _32
            reached[i] = codes[1, i] & _LOW
            results[0, i] = distance[v] if bends[v] else bend[v]
        queued += lower(
            edges, reached, results[2], results[0], now, per_band, least, settled, distance, bend, band, waiting, filled
        )
    for v in range(len(distance)):
        if distance[v] > radius:
            distance[v] = np.inf


@compiled
def _meet(
    size: np.uint64, front: Indices, passed: float, start: Indices, ring: Indices, ring_length: Lengths,
    distance: Floats, codes: Codes, results: Floats,
) -> tuple[np.uint64, np.uint64]:  # fmt: skip
    """Around each vertex of the front: faces with one further settled vertex, edges that shorten a distance.

    A face whose vertices are all settled counts too if one of its angles is blunt: the front passed that vertex before
    it reached the far end of the edge through which the straight line comes.

    codes[0] : vertex << 32 | 2 × ring entry + 1 if the settled neighbour is the entry before
    codes[1] : vertex << 32 | neighbour, with the distance along the edge in results[2]
    """
    pairs, edges = _0, _0
    for i in range(size):
        v = np.uint64(front[i])
        own, high = distance[v], v << _32
        # a vertex lowered late meets neighbours that the front has passed, though they are farther than itself
        level = max(own, passed)
        before = _0
        for j in range(np.uint64(start[v]), np.uint64(start[v + _1])):
            entry = np.uint64(ring[j])
            u = entry >> _3
            there = distance[u]
            settled = np.uint64(there <= level)
            both, blunt_before, blunt = settled & before, entry >> _1 & _1, entry >> _2 & _1
            codes[0, pairs] = high | (j + j + (blunt if both else before))
            pairs += entry & ((settled ^ before) | (both & (blunt_before | blunt)))
            before = settled
            along = own + ring_length[j]
            codes[1, edges] = high | u
            results[2, edges] = along
            edges += np.uint64(along < there)
    return pairs, edges


@compiled
def _load(
    first: np.uint64, count: np.uint64, codes: Codes, start: Indices, ring: Indices, ring_length: Lengths,
    ring_rim: Lengths, distance: Floats, bend: Floats, W: Floats, small: Indices,
) -> None:  # fmt: skip
    """A block of faces for `unfold_first`; small[0] gets their codes, small[1] the vertices to be reached."""
    for i in range(count):
        code = codes[0, first + i]
        v, turn, j = code >> _32, code & _1, (code & _LOW) >> _1
        settled, open_ = j - turn, j + turn - _1
        u = np.uint64(ring[settled]) >> _3
        small[0, i] = code & _LOW
        small[1, i] = np.uint64(ring[open_]) >> _3
        # the flatter of two wave fronts: the rounder one would shine behind the bend it came from
        sigma = min(bend[u], bend[v])
        W[i + NEAR] = distance[v] - sigma
        W[i + OTHER] = distance[u] - sigma
        W[i + BASE] = ring_length[settled]
        W[i + SIDE] = ring_length[open_]
        W[i + RIM] = ring_rim[j]
        W[i + SIGMA] = sigma


@compiled
def _collect(count: np.uint64, apex: Indices, W: Floats, found: np.uint64, reached: Indices, results: Floats) -> np.uint64:
    """Append the vertices that see their virtual source through the edge: where, how far, and the bend behind it."""
    for i in range(count):
        reached[found] = apex[i]
        results[0, found] = W[i + REACH]
        results[1, found] = W[i + SIGMA]
        found += np.uint64((W[i + Y] > 0.0) & (W[i + FROM_LEFT] >= 0.0) & (W[i + FROM_RIGHT] >= 0.0))
    return found
