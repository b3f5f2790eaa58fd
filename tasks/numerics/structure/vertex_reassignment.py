"""To which parts the vertices of a dropped part go (ours)."""

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.compiled import compiled


def reassigned(V: Floats, x: Floats, label: Ints, gone: int, R: Floats, t: Floats, start: Ints, ring: Ints) -> Ints:
    """Labels without one part: its vertices go, from its borders inwards, to the part that moves most like them.

    Each vertex goes to a part that lies next to it, so that every part stays connected.

    V, x        : (vertex, xyz) · (frame, vertex, xyz) mesh unit
    label       : (vertex,) part
    gone        : the part that is dropped
    R, t        : (frame, part, 3, 3) · (frame, part, xyz)
    start, ring : neighbours of every vertex, see `neighbours.rings`
    returns     : (vertex,) part
    """
    out = label.copy()
    waiting = np.flatnonzero(label == gone)
    cost = _costs(V, x, waiting, R, t)
    place = np.full(len(V), -1)
    place[waiting] = np.arange(len(waiting))
    _grown(out, place, cost, waiting, gone, start, ring)
    return out


@compiled
def _costs(V: Floats, x: Floats, rows: Ints, R: Floats, t: Floats) -> Floats:
    """(row, part) mean square distance of vertices to where each part would carry them."""
    out = np.zeros((len(rows), R.shape[1]))
    for n in range(len(rows)):
        v = rows[n]
        for f in range(len(x)):
            for p in range(R.shape[1]):
                for i in range(3):
                    away = R[f, p, i, 0] * V[v, 0] + R[f, p, i, 1] * V[v, 1] + R[f, p, i, 2] * V[v, 2] + t[f, p, i] - x[f, v, i]
                    out[n, p] += away * away / len(x)
    return out


@compiled
def _grown(label: Ints, place: Ints, cost: Floats, waiting: Ints, gone: int, start: Ints, ring: Ints) -> None:
    """Front from the neighbours: in every round a vertex takes the cheapest label around it, until none changes."""
    for _ in range(4 * len(waiting) + 1):
        changed = False
        before = label.copy()
        for v in waiting:
            best = before[v]
            least = np.inf if best == gone else cost[place[v], best]
            for e in range(start[v], start[v + 1]):
                p = before[ring[e]]
                if p != gone and cost[place[v], p] < least:
                    best, least = p, cost[place[v], p]
            if best != before[v]:
                label[v] = best
                changed = True
        if not changed:
            return
