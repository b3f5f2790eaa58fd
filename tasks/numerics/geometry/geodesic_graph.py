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
from kinetree.tasks.numerics.geometry.visibility import (
    MAX_LINES,
    MAX_WINDOWS,
    FaceShapes,
    Lines,
    Rings,
    append_edges,
    append_visible,
    face_shapes,
)

Codes = npt.NDArray[np.uint16]
Records = npt.NDArray[np.void]

NARROWEST_WINDOW = np.deg2rad(16.0)
"""Angle below which a window of directions is dropped; 20° costs a third less and errs twice as much."""
LARGEST_TURN = np.deg2rad(30.0)
"""Angle, beside half a sector, by which a path may turn at a vertex; with 20° paths miss vertices on rough bodies."""
DETOUR = 0.004
"""A link is left out if two others are longer by no more than this share."""
COMPARED_LINKS = 5
"""Links on either side, by direction, that are tried in place of one."""
LOOK_RADIUS = 8.0
"""Mean edges around a vertex up to which it looks; not recorded how far less would do."""
SECTORS = 31
"""Directions of arrival that are distinguished; one more stands for "from anywhere"."""
BITS = 5
"""Bits that a sector takes beside a vertex number."""
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


def visibility_links(rings: Rings, angle: Floats, free: npt.NDArray[np.uint8]) -> tuple[Indices, Records, Codes]:
    """First three fields of `Links`.

    rings : start, ring, ring_edge, apex, twin, length and ring_length of the surface
    angle : (half-edge,) at its tail
    free  : (vertex,) 1 where faces are not one closed ring, so that "straight on" has no meaning
    """
    # called step by step: inside one compiled function all of this would be compiled a second time
    shape, total = face_shapes(rings[0], rings[1], rings[2], angle, rings[5])
    first, lines = _visible_from_each(rings, shape)
    first, lines = _both_ways(first, lines, total, free)
    most = np.uint64(np.diff(first).max(initial=0))
    first, (target, length, out, back) = _ordered(first, lines, total, free, most)
    link = np.empty(len(target), LINK)
    link["target"], link["length"] = _with_sectors(target, back, total), length
    return first, link, _onward(first, out, total, free)


@compiled
def _visible_from_each(rings: Rings, shape: FaceShapes) -> tuple[Indices, Lines]:
    """What each vertex sees, by vertex: target, distance, direction here and direction there."""
    start, ring_length, n = rings[0], rings[6], np.uint64(len(rings[0]) - 1)
    first, place = np.zeros(n + _1, np.uint32), np.zeros(n, np.uint32)
    windows, crossing = np.empty((MAX_WINDOWS, 8)), np.empty(MAX_WINDOWS, np.uint32)
    k, lines = _0, _empty_lines(np.uint64(40) * n)
    for v in range(n):
        entries = np.uint64(start[v + _1]) - np.uint64(start[v])
        if k + entries + entries + np.uint64(MAX_LINES) > np.uint64(len(lines[0])):
            lines = _enlarged(lines, k, k + k // np.uint64(2) + entries + entries + np.uint64(MAX_LINES))
        far = 0.0
        for j in range(np.uint64(start[v]), np.uint64(start[v + _1])):
            far += LOOK_RADIUS * ring_length[j] / entries
        beyond = append_edges(np.uint64(v), rings, shape, place, k, lines)
        k = append_visible(
            np.uint64(v), far * far, np.sin(NARROWEST_WINDOW), rings, shape, place, k, beyond, lines, windows, crossing
        )
        first[v + _1] = k
    return first, lines


@compiled
def _empty_lines(links: np.uint64) -> Lines:
    """Memory for so many lines."""
    return np.empty(links, np.uint32), np.empty(links, np.float32), np.empty(links, np.float32), np.empty(links, np.float32)


@compiled
def _enlarged(lines: Lines, count: np.uint64, links: np.uint64) -> Lines:
    """Memory for more lines that holds the first ones."""
    larger = _empty_lines(links)
    for k in range(count):
        larger[0][k], larger[1][k], larger[2][k], larger[3][k] = lines[0][k], lines[1][k], lines[2][k], lines[3][k]
    return larger


@compiled
def _both_ways(first: Indices, lines: Lines, total: Floats, free: npt.NDArray[np.uint8]) -> tuple[Indices, Lines]:
    """Every link from both its ends, by vertex; some are there twice."""
    n = np.uint64(len(total))
    begin = np.zeros(n + _1, np.uint32)
    for v in range(n):
        begin[v + _1] += first[v + _1] - first[v]
        for k in range(np.uint64(first[v]), np.uint64(first[v + _1])):
            begin[np.uint64(lines[0][k]) + _1] += np.uint32(1)
    for v in range(n):
        begin[v + _1] += begin[v]
    both, end = _empty_lines(np.uint64(begin[n])), begin[:-1].copy()
    target, length, out, back = both
    for v in range(n):
        for k in range(np.uint64(first[v]), np.uint64(first[v + _1])):
            w, leaving, arriving = np.uint64(lines[0][k]), lines[2][k], lines[3][k]
            if arriving >= total[w] and not free[w]:
                arriving -= np.float32(total[w])
            i, j = np.uint64(end[v]), np.uint64(end[w])
            target[i], length[i], out[i], back[i] = w, lines[1][k], leaving, arriving
            target[j], length[j], out[j], back[j] = v, lines[1][k], arriving, leaving
            end[v] += np.uint32(1)
            end[w] += np.uint32(1)
    return begin, both


@compiled
def _ordered(begin: Indices, both: Lines, total: Floats, free: npt.NDArray[np.uint8], most: np.uint64) -> tuple[Indices, Lines]:
    """Each link once, sorted by direction, without those that two others serve as well; a vertex has at most `most`."""
    target, length, out, back = both
    first, place, key, own_lines = (
        np.zeros_like(begin),
        np.zeros(len(total), np.uint32),
        np.empty(most, np.uint64),
        _empty_lines(most),
    )
    k = _0
    for v in range(len(total)):
        size = _sorted(np.uint64(begin[v]), np.uint64(begin[v + 1]), both, place, key)
        for i in range(size):
            j = key[i] & _LOW
            own_lines[0][i], own_lines[1][i], own_lines[2][i], own_lines[3][i] = target[j], length[j], out[j], back[j]
        # links count of one vertex never overwrite those of the next, which are not read yet
        for i in range(size):
            if not _is_redundant(np.uint64(i), size, total[v], not free[v], own_lines[1], own_lines[2]):
                target[k], length[k], out[k], back[k] = own_lines[0][i], own_lines[1][i], own_lines[2][i], own_lines[3][i]
                k = k + _1
        first[v + 1] = k
    return first, (target[:k].copy(), length[:k].copy(), out[:k].copy(), back[:k].copy())


@compiled
def _sorted(begin: np.uint64, end: np.uint64, both: Lines, place: Indices, key: npt.NDArray[np.uint64]) -> np.uint64:
    """Places of one vertex's links in the low half of `key`, by direction; how many. Of two to the same target the shorter."""
    target, length, out, back = both
    size = _0
    for i in range(begin, end):
        w = np.uint64(target[i])
        j = np.uint64(place[w])
        if j <= begin:
            place[w], key[size] = np.uint64(i) + _1, i
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
def _is_redundant(i: np.uint64, size: np.uint64, total: float, closed: bool, length: Lengths, out: Lengths) -> bool:
    """Whether link i may as well bend at the end of a shorter one in nearly the same direction."""
    far, forth, back = np.float64(length[i]), i, i
    for _ in range(min(np.uint64(COMPARED_LINKS), size - _1)):
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
    """The `onward` of `Links`."""
    onward = np.zeros((len(total), SECTORS + 1), np.uint16)
    for v in range(len(total)):
        if not free[v]:
            _straight_on(out[first[v] : first[v + 1]], total[v], onward[v])
    return onward


@compiled
def _straight_on(out: Lengths, total: float, onward: Codes) -> None:
    """For each sector of arrival, the links that go straight on: past the vertex on either side half a turn away."""
    size, half = len(out), abs(0.5 * total - np.pi) + LARGEST_TURN
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
