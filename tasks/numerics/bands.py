"""A queue of vertices in narrow bands of distance, a ring of them: what a front needs in place of a heap."""

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.compiled import compiled

Floats = npt.NDArray[np.float64]
Indices = npt.NDArray[np.uint32]

BANDS = 64  # a power of two; vertices further ahead wait in the last one
IDLE = np.uint64(0xFFFFFFFF)
_0, _1 = np.uint64(0), np.uint64(1)


@compiled
def enter(
    source: np.uint64, exact: float, begin: float, per_band: float, distance: Floats, bend: Floats, band: Indices,
    waiting: Indices, filled: Indices, met: Indices,
) -> tuple[float, np.uint64, np.uint64]:  # fmt: skip
    """Queue what the light around the source met from distance `begin` on; up to where it is exact, first band, how many.

    Where light was lost at a blind edge nothing is exact, and the front begins at the source itself.
    """
    count = np.uint64(met[-2])
    if met[-1]:
        for k in range(count):
            distance[met[k]] = np.inf
        distance[source], bend[source] = 0.0, 0.0
        exact, begin, count, met[0] = -1.0, 0.0, _1, source
    first, queued = np.uint64(max(begin, 0.0) * per_band) if begin < np.inf else _0, _0
    for k in range(count):
        v = np.uint64(met[k])
        if distance[v] >= begin:
            due = min(np.uint64(distance[v] * per_band), first + np.uint64(BANDS - 1))
            band[v] = due
            waiting[due & np.uint64(BANDS - 1), np.uint64(filled[due & np.uint64(BANDS - 1)])] = v
            filled[due & np.uint64(BANDS - 1)] += np.uint32(1)
            queued += _1
    return exact, first, queued


@compiled
def advance(
    now: np.uint64, per_band: float, distance: Floats, band: Indices, waiting: Indices, filled: Indices, front: Indices
) -> np.uint64:
    """Take the vertices of band `now` off the queue; those that only waited in it move on."""
    row = now & np.uint64(BANDS - 1)
    held = np.uint64(filled[row])
    filled[row] = 0
    size = _0
    for i in range(held):
        v = np.uint64(waiting[row, i])
        if np.uint64(band[v]) != now:
            continue
        due = np.uint64(distance[v] * per_band)
        if due > now:
            due = min(due, now + np.uint64(BANDS - 1))
            band[v] = due
            later = due & np.uint64(BANDS - 1)
            waiting[later, np.uint64(filled[later])] = v
            filled[later] += np.uint32(1)
            continue
        band[v] = IDLE
        front[size] = v
        size += _1
    return size


@compiled
def lower(
    count: np.uint64, vertex: Indices, value: Floats, origin: Floats, now: np.uint64, per_band: float, least: float,
    exact: float, distance: Floats, bend: Floats, band: Indices, waiting: Indices, filled: Indices,
) -> np.uint64:  # fmt: skip
    """Take the smaller distance where it is shorter by `least` and the old one above `exact`, and queue the vertex.

    Returns how many were not queued before.

    Without branches: half of the candidates are no improvement, in no order that a processor could learn.
    """
    added = _0
    for i in range(count):
        v, new, old = np.uint64(vertex[i]), value[i], distance[np.uint64(vertex[i])]
        better = (new < old - least) & (old > exact)
        distance[v] = new if better else old
        bend[v] = origin[i] if better else bend[v]
        was = np.uint64(band[v])
        due = min(min(max(np.uint64(new * per_band), now), now + np.uint64(BANDS - 1)), was)
        row = due & np.uint64(BANDS - 1)
        waiting[row, np.uint64(filled[row])] = v
        filled[row] += np.uint32(better & (was != due))
        added += np.uint64(better & (was == IDLE))
        band[v] = due if better else was
    return added
