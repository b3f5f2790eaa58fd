"""Shortest paths over the links of a surface in bands of distance: Dijkstra's order without a heap (2014, Eq. 1: g).

After Dial 1969; a vertex may be worked off a second time where a band is wider than a link.
"""

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Indices
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.geometry.geodesic_graph import ANYWHERE, BITS, Links

Workspace = tuple[Floats, Indices, Indices, Indices]

BAND_WIDTH = 0.8
"""Mean edges; few links are shorter, so that few vertices are worked off before their distance is final."""
BANDS = 64
"""Bands in the queue, a power of two; vertices further ahead wait in the last one."""
SHORTER = 0.99
"""A path along an edge is taken up if it makes a distance this share of what it was, or less."""
_0, _1, _8, _LOW = np.uint64(0), np.uint64(1), np.uint64(8), np.uint64(0xFF)
_BITS, _SECTOR, _ANYWHERE = np.uint64(BITS), np.uint64((1 << BITS) - 1), np.uint64(ANYWHERE)
_LAST, _LINE = np.uint64(BANDS - 1), np.uint64(7)
IDLE, REQUEUED = np.uint64(0xFFFFFFFF), np.uint64(0xFFFFFFFE)
"""In place of a band: a vertex that is not in the queue · one that is to be queued again."""


@compiled
def workspace(vertices: int, links: int) -> Workspace:
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
def propagate(mesh: Links, source: np.uint64, edge: float, radius: float, work: Workspace) -> None:
    """Writes the distances from one source into work[0]; nothing of what `work` held before is used.

    mesh   : links of the surface
    source : vertex in the surface's own numbering
    edge   : the surface's mean edge, mesh unit
    radius : mesh unit; what is farther becomes infinite
    """
    distance, due, _, filled = work
    distance[:] = np.inf
    due[:] = IDLE
    filled[:] = 0
    distance[source] = 0.0
    per_band = 1.0 / (BAND_WIDTH * edge)
    _enqueue(source, _0, per_band, work)
    _run(_0, mesh, per_band, radius, work)


@compiled
def _enqueue(v: np.uint64, now: np.uint64, per_band: float, work: Workspace) -> None:
    """Queues a vertex whose path comes from anywhere; all bands before `now` are empty."""
    distance, due, waiting, filled = work
    band = min(np.uint64(distance[v] * per_band), now + _LAST)
    due[v] = (band << _BITS) | _ANYWHERE
    row = band & _LAST
    place = np.uint64(filled[row])
    waiting[row, place] = v
    filled[row] = min(place + _1, np.uint64(waiting.shape[1] - 1))


@compiled
def _run(now: np.uint64, mesh: Links, per_band: float, radius: float, work: Workspace) -> None:
    """Empties the queue from band `now` on, and again where an edge turns out to be a shorter path."""
    distance, _, _, filled = work
    last = min(radius * per_band, 2.0**26)
    while now <= last:
        empty = _0
        while now <= last and empty <= _LAST:
            empty = empty + _1 if filled[now & _LAST] == 0 else _0
            _relax_band(now, mesh, per_band, work)
            now += _1
        now = _requeue_along_edges(mesh, per_band, radius, work)
    for v in range(len(distance)):
        if distance[v] > radius:
            distance[v] = np.inf


@compiled
def _relax_band(now: np.uint64, mesh: Links, per_band: float, work: Workspace) -> None:
    """Follows the links straight on from every vertex due in one band, including those that become due in it meanwhile."""
    first, link, onward, _, _ = mesh
    distance, due, waiting, filled = work
    row, i, ready = now & _LAST, _0, _0
    most = np.uint64(waiting.shape[1] - 1)
    while i < np.uint64(filled[row]):
        if i == ready:
            ready = np.uint64(filled[row])
            waiting[row, most] = _prefetch(i, ready, waiting[row], mesh, due)
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
        k, remaining = begin + (ahead >> _8), ahead & _LOW
        if ahead == _0:
            k, remaining = begin, end - begin
        for _ in range(remaining):
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
def _prefetch(begin: np.uint64, end: np.uint64, waiting: Indices, mesh: Links, due: Indices) -> np.uint32:
    """Reads what these vertices will need, so that it is in the cache: memory serves several reads in the time of one.

    The returned number has no meaning; it must be stored, or the compiler would leave the reads out.
    """
    first, link, onward, _, _ = mesh
    total, last = _0, np.uint64(len(link) - 1)
    for i in range(begin, end):
        v = np.uint64(waiting[i])
        k = np.uint64(first[v]) + (np.uint64(onward[v, np.uint64(due[v]) & _SECTOR]) >> _8)
        total += np.uint64(link[min(k, last)].target) + np.uint64(link[min(k + _LINE, last)].target)
    return np.uint32(total)


@compiled
def _requeue_along_edges(mesh: Links, per_band: float, radius: float, work: Workspace) -> np.uint64:
    """Queues every vertex that an edge makes clearly nearer; returns the first band with one."""
    edge, along = mesh[3], mesh[4]
    distance, due, _, _ = work
    least = np.inf
    for e in range(len(along)):
        a, b = distance[edge[e, 0]], distance[edge[e, 1]]
        nearer = min(a, b) + along[e]
        if nearer < SHORTER * max(a, b) and nearer <= radius:
            w = edge[e, 0] if a > b else edge[e, 1]
            distance[w], due[w] = nearer, REQUEUED
            least = min(least, nearer)
    if least == np.inf:
        return REQUEUED >> _BITS
    now = np.uint64(least * per_band)
    for v in range(len(distance)):
        if np.uint64(due[v]) == REQUEUED:
            _enqueue(np.uint64(v), now, per_band, work)
    return now
