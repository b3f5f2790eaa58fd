"""A front that runs over the links of a surface in bands: Dijkstra's order without a heap (2014, Eq. 1: g)."""

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Indices
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.geometry.geodesic_graph import ANYWHERE, BITS, Links

Room = tuple[Floats, Indices, Indices, Indices]

BAND = 0.8  # mean edges: few links are shorter, so that hardly a vertex goes on before its distance is known
BANDS = 64  # a power of two; vertices further ahead wait in the last one
MENDED = 0.99  # a path along an edge counts if it makes this much of a distance of it or less
_0, _1, _8, _LOW = np.uint64(0), np.uint64(1), np.uint64(8), np.uint64(0xFF)
_BITS, _SECTOR, _ANYWHERE = np.uint64(BITS), np.uint64((1 << BITS) - 1), np.uint64(ANYWHERE)
_LAST, _LINE = np.uint64(BANDS - 1), np.uint64(7)
IDLE, LATE = np.uint64(0xFFFFFFFF), np.uint64(0xFFFFFFFE)


@compiled
def workspace(vertices: int, links: int) -> Room:
    """Memory for one propagation at a time over so many vertices and links.

    distance : (vertex,) in the surface's own numbering
    due      : (vertex,) 32 × band in which the vertex is due + sector from which its path arrived, or IDLE
    waiting  : (band, place) vertices, those that have been moved to an earlier band included
    filled   : (band,) how many
    """
    places = min(2 * vertices, vertices + links) + 2
    return (
        np.empty(vertices),
        np.empty(vertices, np.uint32),
        np.empty((BANDS, places), np.uint32),
        np.zeros(BANDS, np.uint32),
    )


@compiled
def propagate(mesh: Links, source: np.uint64, edge: float, radius: float, room: Room) -> None:
    """Distances from one source into room[0]; the only state is `room`.

    source : vertex in the surface's own numbering
    edge   : the surface's mean edge, mesh unit
    radius : mesh unit; what is farther becomes infinite
    """
    distance, due, _, filled = room
    distance[:] = np.inf
    due[:] = IDLE
    filled[:] = 0
    distance[source] = 0.0
    per_band = 1.0 / (BAND * edge)
    enter(source, _0, per_band, room)
    advance(_0, mesh, per_band, radius, room)


@compiled
def enter(v: np.uint64, now: np.uint64, per_band: float, room: Room) -> None:
    """Queue a vertex whose path comes from anywhere; no band before `now` is left to be worked off."""
    distance, due, waiting, filled = room
    band = min(np.uint64(distance[v] * per_band), now + _LAST)
    due[v] = (band << _BITS) | _ANYWHERE
    row = band & _LAST
    place = np.uint64(filled[row])
    waiting[row, place] = v
    filled[row] = min(place + _1, np.uint64(waiting.shape[1] - 1))


@compiled
def advance(now: np.uint64, mesh: Links, per_band: float, radius: float, room: Room) -> None:
    """Run the queue dry from band `now` on, and again wherever an edge is found to be a shorter path."""
    distance, _, _, filled = room
    last = min(radius * per_band, 2.0**26)
    while now <= last:
        empty = _0
        while now <= last and empty <= _LAST:
            empty = empty + _1 if filled[now & _LAST] == 0 else _0
            _work_off(now, mesh, per_band, room)
            now += _1
        now = _mend(mesh, per_band, radius, room)
    for v in range(len(distance)):
        if distance[v] > radius:
            distance[v] = np.inf


@compiled
def _work_off(now: np.uint64, mesh: Links, per_band: float, room: Room) -> None:
    """Follow the links straight on from every vertex due in one band, those included that it makes due in it."""
    first, link, onward, _, _ = mesh
    distance, due, waiting, filled = room
    row, i, ready = now & _LAST, _0, _0
    most = np.uint64(waiting.shape[1] - 1)
    while i < np.uint64(filled[row]):
        if i == ready:
            ready = np.uint64(filled[row])
            waiting[row, most] = _fetch(i, ready, waiting[row], mesh, due)
        v = np.uint64(waiting[row, i])
        i += _1
        mark, own = np.uint64(due[v]), distance[v]
        if mark >> _BITS != now:
            continue
        band = np.uint64(own * per_band)
        if band > now:
            band = min(band, now + _LAST)
            due[v] = (band << _BITS) | (mark & _SECTOR)
            later = band & _LAST
            place = np.uint64(filled[later])
            waiting[later, place] = v
            filled[later] = min(place + _1, most)
            continue
        due[v] = IDLE
        begin, end = np.uint64(first[v]), np.uint64(first[v + _1])
        ahead = np.uint64(onward[v, mark & _SECTOR])
        k, left = begin + (ahead >> _8), ahead & _LOW
        if ahead == _0:
            k, left = begin, end - begin
        for _ in range(left):
            code, far = np.uint64(link[k].target), own + link[k].length
            w = code >> _BITS
            if far < distance[w]:
                distance[w] = far
                band = min(np.uint64(far * per_band), now + _LAST)
                was = np.uint64(due[w]) >> _BITS
                if band < was:
                    later = band & _LAST
                    place = np.uint64(filled[later])
                    waiting[later, place] = w
                    filled[later] = min(place + _1, most)
                    was = band
                due[w] = (was << _BITS) | (code & _SECTOR)
            k = k + _1 if k + _1 < end else begin
    filled[row] = 0


@compiled
def _fetch(begin: np.uint64, end: np.uint64, waiting: Indices, mesh: Links, due: Indices) -> np.uint32:
    """Read what these vertices will need: all at once, memory serves several of them in the time that it takes for one.

    Returns a number of no meaning, which must be kept lest the compiler leave out what nobody asks for.
    """
    first, link, onward, _, _ = mesh
    total, last = _0, np.uint64(len(link) - 1)
    for i in range(begin, end):
        v = np.uint64(waiting[i])
        k = np.uint64(first[v]) + (np.uint64(onward[v, np.uint64(due[v]) & _SECTOR]) >> _8)
        total += np.uint64(link[min(k, last)].target) + np.uint64(link[min(k + _LINE, last)].target)
    return np.uint32(total)


@compiled
def _mend(mesh: Links, per_band: float, radius: float, room: Room) -> np.uint64:
    """Queue every vertex that an edge brings nearer by much, to look around from there; the first band with one."""
    edge, along = mesh[3], mesh[4]
    distance, due, _, _ = room
    least = np.inf
    for e in range(len(along)):
        a, b = distance[edge[e, 0]], distance[edge[e, 1]]
        nearer = min(a, b) + along[e]
        if nearer < MENDED * max(a, b) and nearer <= radius:
            w = edge[e, 0] if a > b else edge[e, 1]
            distance[w], due[w] = nearer, LATE
            least = min(least, nearer)
    if least == np.inf:
        return LATE >> _BITS
    now = np.uint64(least * per_band)
    for v in range(len(distance)):
        if np.uint64(due[v]) == LATE:
            enter(np.uint64(v), now, per_band, room)
    return now
