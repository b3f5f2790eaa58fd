"""Links between the vertices of a surface: a graph whose shortest paths are nearly geodesic (2014, Sec. 4, Eq. 1: g).

After the saddle vertex graph (Ying, Wang, He 2013) and the discrete geodesic graph (Wang et al. 2017): every vertex is
linked to what it sees and to what sees it, by straight lines of exact length. A shortest path hardly turns; so at a vertex
only the links straight on from where the path came need be followed, fewer than a vertex has edges and a few per cent of
what there is. All this is prepared once per surface, at the price of about a hundred sources.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.arrays import Floats, Indices, Lengths
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.geometry.visibility import DEPTH, MOST, Corners, Found, Rings, corners, edges_of, shine

Codes = npt.NDArray[np.uint16]
Records = npt.NDArray[np.void]

NARROW = np.deg2rad(16.0)  # light is split down to this angle: 20° costs a third less and errs twice as much
STRAIGHT = np.deg2rad(30.0)  # a path may turn by this much and half a sector; by 20°, and it misses vertices on rough bodies
DETOUR = 0.004  # a link is left out if two others are longer by no more than this share
NEIGHBOURS = 5  # in direction, on either side, that may serve a link
FAR = 8.0  # mean edges around a vertex in which it looks
SECTORS = 31  # directions of arrival that are told apart; one more stands for "from anywhere"
BITS = 5
LINK = np.dtype([("target", np.uint32), ("length", np.float32)])
ANYWHERE = SECTORS
_0, _1, _32, _LOW = np.uint64(0), np.uint64(1), np.uint64(32), np.uint64(0xFFFFFFFF)


class Links(NamedTuple):
    """The graph of one surface, in its own numbering.

    first  : (vertex + 1,) where each vertex's links begin; they are sorted by direction
    link   : (link,) `target`, 32 × vertex at the other end + sector of its directions in which the link arrives there, and
             `length`, mesh unit: side by side in memory, where most of the time goes
    onward : (vertex, sector) 256 × first link to follow, counted from the vertex's own first, + how many; after the
             last comes the first again. 0 is all of them, as in the last column, for paths from anywhere
    edge   : (edge, 2) vertices at its ends
    along  : (edge,) mesh unit
    """

    first: Indices
    link: Records
    onward: Codes
    edge: Indices
    along: Lengths


def linked(rings: Rings, angle: Floats, free: npt.NDArray[np.uint8]) -> tuple[Indices, Records, Codes]:
    """First three of `Links`, of a surface whose start, ring, ring_edge, apex, twin, length and ring_length are `rings`.

    angle : (half-edge,) at its tail
    free  : (vertex,) 1 where faces are not one closed ring, so that "straight on" has no meaning
    """
    # step by step: called from one compiled function, all of this would be compiled once more into that
    shape, total = corners(rings[0], rings[1], rings[2], angle, rings[5])
    first, found = _seen_from_all(rings, shape)
    first, found = _both_ways(first, found, total, free)
    most = np.uint64(np.diff(first).max(initial=0))
    first, (target, length, out, back) = _ordered(first, found, total, free, most)
    link = np.empty(len(target), LINK)
    link["target"], link["length"] = _with_sectors(target, back, total), length
    return first, link, _onward(first, out, total, free)


@compiled
def _seen_from_all(rings: Rings, shape: Corners) -> tuple[Indices, Found]:
    """What each vertex sees, by vertex: target, distance, direction here and direction there."""
    start, ring_length, n = rings[0], rings[6], np.uint64(len(rings[0]) - 1)
    first, seen = np.zeros(n + _1, np.uint32), np.zeros(n, np.uint32)
    windows, crossing = np.empty((DEPTH, 8)), np.empty(DEPTH, np.uint32)
    k, found = _0, _room(np.uint64(40) * n)
    for v in range(n):
        entries = np.uint64(start[v + _1]) - np.uint64(start[v])
        if k + entries + entries + np.uint64(MOST) > np.uint64(len(found[0])):
            found = _enlarged(found, k, k + k // np.uint64(2) + entries + entries + np.uint64(MOST))
        far = 0.0
        for j in range(np.uint64(start[v]), np.uint64(start[v + _1])):
            far += FAR * ring_length[j] / entries
        beyond = edges_of(np.uint64(v), rings, shape, seen, k, found)
        k = shine(np.uint64(v), far * far, np.sin(NARROW), rings, shape, seen, k, beyond, found, windows, crossing)
        first[v + _1] = k
    return first, found


@compiled
def _room(links: np.uint64) -> Found:
    return np.empty(links, np.uint32), np.empty(links, np.float32), np.empty(links, np.float32), np.empty(links, np.float32)


@compiled
def _enlarged(found: Found, kept: np.uint64, links: np.uint64) -> Found:
    larger = _room(links)
    for k in range(kept):
        larger[0][k], larger[1][k], larger[2][k], larger[3][k] = found[0][k], found[1][k], found[2][k], found[3][k]
    return larger


@compiled
def _both_ways(first: Indices, found: Found, total: Floats, free: npt.NDArray[np.uint8]) -> tuple[Indices, Found]:
    """Every link from both its ends, by vertex; some are there twice."""
    n = np.uint64(len(total))
    begin = np.zeros(n + _1, np.uint32)
    for v in range(n):
        begin[v + _1] += first[v + _1] - first[v]
        for k in range(np.uint64(first[v]), np.uint64(first[v + _1])):
            begin[np.uint64(found[0][k]) + _1] += np.uint32(1)
    for v in range(n):
        begin[v + _1] += begin[v]
    both, end = _room(np.uint64(begin[n])), begin[:-1].copy()
    target, length, out, back = both
    for v in range(n):
        for k in range(np.uint64(first[v]), np.uint64(first[v + _1])):
            w, leaving, arriving = np.uint64(found[0][k]), found[2][k], found[3][k]
            if arriving >= total[w] and not free[w]:
                arriving -= np.float32(total[w])
            i, j = np.uint64(end[v]), np.uint64(end[w])
            target[i], length[i], out[i], back[i] = w, found[1][k], leaving, arriving
            target[j], length[j], out[j], back[j] = v, found[1][k], arriving, leaving
            end[v] += np.uint32(1)
            end[w] += np.uint32(1)
    return begin, both


@compiled
def _ordered(begin: Indices, both: Found, total: Floats, free: npt.NDArray[np.uint8], most: np.uint64) -> tuple[Indices, Found]:
    """Each link once, sorted by direction, without those that two others serve as well; a vertex has at most `most`."""
    target, length, out, back = both
    first, seen, key, one = np.zeros_like(begin), np.zeros(len(total), np.uint32), np.empty(most, np.uint64), _room(most)
    k = _0
    for v in range(len(total)):
        size = _sorted(np.uint64(begin[v]), np.uint64(begin[v + 1]), both, seen, key)
        for i in range(size):
            j = key[i] & _LOW
            one[0][i], one[1][i], one[2][i], one[3][i] = target[j], length[j], out[j], back[j]
        # what is kept of one vertex never reaches into what is left of the next
        for i in range(size):
            if not _served(np.uint64(i), size, total[v], not free[v], one[1], one[2]):
                target[k], length[k], out[k], back[k] = one[0][i], one[1][i], one[2][i], one[3][i]
                k = k + _1
        first[v + 1] = k
    return first, (target[:k].copy(), length[:k].copy(), out[:k].copy(), back[:k].copy())


@compiled
def _sorted(begin: np.uint64, end: np.uint64, both: Found, seen: Indices, key: npt.NDArray[np.uint64]) -> np.uint64:
    """Places of one vertex's links in the low half of `key`, by direction; how many. Of two to the same target the shorter."""
    target, length, out, back = both
    size = _0
    for i in range(begin, end):
        w = np.uint64(target[i])
        j = np.uint64(seen[w])
        if j <= begin:
            seen[w], key[size] = np.uint64(i) + _1, i
            size = size + _1
        elif length[i] < length[j - _1]:
            length[j - _1], out[j - _1], back[j - _1] = length[i], out[i], back[i]
    for i in range(size):
        own = (np.uint64(max(out[key[i]], 0.0) * 1e6) << _32) | key[i]
        j = np.uint64(i)
        while j > _0 and key[j - _1] > own:
            key[j] = key[j - _1]
            j = j - _1
        key[j] = own
    return size


@compiled
def _served(i: np.uint64, size: np.uint64, total: float, closed: bool, length: Lengths, out: Lengths) -> bool:
    """Whether link i may as well bend at the end of a shorter one in nearly the same direction."""
    far, forth, back = np.float64(length[i]), i, i
    for _ in range(min(np.uint64(NEIGHBOURS), size - _1)):
        forth = forth + _1 if forth + _1 < size else _0
        back = back - _1 if back > _0 else size - _1
        for j in (forth, back):
            near, apart = np.float64(length[j]), abs(np.float64(out[i]) - np.float64(out[j]))
            if closed:
                apart = min(apart, total - apart)
            # the law of cosines, for a small angle
            if near < far and near * apart * apart < DETOUR * (2.0 * (far - near) + DETOUR * far):
                return True
    return False


@compiled
def _with_sectors(target: Indices, back: Lengths, total: Floats) -> Indices:
    """The targets of `Links`."""
    code = np.empty_like(target)
    for k in range(len(target)):
        share = back[k] / total[target[k]] if total[target[k]] > 0.0 else 0.0
        code[k] = (target[k] << np.uint32(BITS)) | np.uint32(min(max(share * SECTORS, 0.0), SECTORS - 1.0))
    return code


@compiled
def _onward(first: Indices, out: Lengths, total: Floats, free: npt.NDArray[np.uint8]) -> Codes:
    onward = np.zeros((len(total), SECTORS + 1), np.uint16)
    for v in range(len(total)):
        if not free[v]:
            _look_onward(out[first[v] : first[v + 1]], total[v], onward[v])
    return onward


@compiled
def _look_onward(out: Lengths, total: float, onward: Codes) -> None:
    """For each sector of arrival, the links that go straight on: past the vertex on either side half a turn away."""
    size, half = len(out), abs(0.5 * total - np.pi) + STRAIGHT
    if 2.0 * half >= total:
        return
    low = (0.5 / SECTORS + 0.5) * total - half
    low += total if low < 0.0 else 0.0
    p, q = 0, 0
    for sector in range(SECTORS):
        while p < 2 * size and _unrolled(out, p, total) < low:
            p += 1
        q = max(p, q)
        while q < p + size and _unrolled(out, q, total) <= low + 2.0 * half:
            q += 1
        if q > p and q - p < 256 and p % size < 256:
            onward[sector] = (p % size) << 8 | (q - p)
        low += total / SECTORS


@compiled
def _unrolled(out: Lengths, i: int, total: float) -> float:
    """The i-th direction, going on around the vertex."""
    around, size = 0.0, len(out)
    while i >= size:
        i -= size
        around += total
    return around + np.float64(out[i])
