"""Backward elimination: parts whose neighbours explain them are given to their neighbours, the least missed first."""

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.structure.labelling import connected, fitted, neighbouring

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Flags = npt.NDArray[np.bool_]


@compiled
def eliminated(
    V: Floats,
    N: Floats,
    x: Floats,
    weight: Floats,
    area: Floats,
    label: Ints,
    R: Floats,
    t: Floats,
    start: Ints,
    ring: Ints,
    threshold: float,
    slip: float,
    floor: float,
) -> tuple[Ints, Floats, Floats]:
    """Drops parts until each one left would be missed by more than `threshold`; see `_missed`.

    V, N        : (vertex, xyz) reference, mesh unit · (vertex, xyz) its unit normals
    x           : (frame, vertex, xyz) mesh unit
    weight      : (frame, vertex) belief
    area        : (vertex,) mesh unit²
    label       : (vertex,) part
    R, t        : (frame, part, 3, 3) · (frame, part, xyz)
    start, ring : neighbours of every vertex
    threshold   : mesh unit
    slip        : what a displacement along the surface counts against one across it, 0 to 1
    floor       : mesh unit², see `labelling.fitted`
    returns     : (vertex,) label · R · t, of the parts dropped too
    """
    parts = R.shape[1]
    label, R, t = label.copy(), R.copy(), t.copy()
    alive = np.zeros(parts, np.bool_)
    for v in range(len(label)):
        if label[v] >= 0:
            alive[label[v]] = True
    score = np.full(parts, np.inf)
    heir = np.full(len(label), -1, np.int64)
    stale = alive.copy()
    while True:
        near = neighbouring(label, parts, start, ring)
        for p in range(parts):
            if alive[p] and stale[p]:
                score[p] = _missed(V, N, x, weight, area, label, p, R, t, near, slip, heir)
        stale[:] = False
        worst = -1
        for p in range(parts):
            if alive[p] and score[p] < threshold and (worst < 0 or score[p] < score[worst]):
                worst = p
        if worst < 0:
            break
        refit = np.zeros(parts, np.bool_)
        for v in range(len(label)):
            if label[v] == worst:
                label[v] = heir[v]
                refit[heir[v]] = True
        alive[worst] = False
        label = connected(label, parts, start, ring)
        for p in range(parts):
            refit[p] |= near[worst, p] > 0
        fitted(V, x, weight, area, label, refit, R, t, floor)
        near = neighbouring(label, parts, start, ring)
        for p in range(parts):
            if refit[p]:
                stale[p] = True
                for q in range(parts):
                    stale[q] |= near[p, q] > 0
    return label, R, t


@compiled
def _missed(
    V: Floats,
    N: Floats,
    x: Floats,
    weight: Floats,
    area: Floats,
    label: Ints,
    part: int,
    R: Floats,
    t: Floats,
    near: Ints,
    slip: float,
    heir: Ints,
) -> float:
    """By how much a part would be missed: L4 norm over frames of the root mean square of what its neighbours leave.

    Each vertex goes to the neighbour, or the blend of two in shares that are the same in all frames, that leaves least.
    What the part leaves itself is taken off. Writes each vertex's best single neighbour to `heir`.
    returns : mesh unit; infinite for a part without neighbours
    """
    count = 0
    for q in range(len(near)):
        count += near[part, q] > 0
    if count == 0:
        return np.inf
    other = np.empty(count, np.int64)
    count = 0
    for q in range(len(near)):
        if near[part, q] > 0:
            other[count] = q
            count += 1
    frames = x.shape[0]
    loss, mass = np.zeros(frames), np.zeros(frames)
    r = np.empty((count, frames, 3))
    own = np.empty((frames, 3))
    E = np.empty((count, count))
    for v in range(len(label)):
        if label[v] != part:
            continue
        _left(V, N, x, weight, v, part, part, R, t, slip, own)
        for a in range(count):
            _left(V, N, x, weight, v, other[a], part, R, t, slip, r[a])
        for a in range(count):
            for b in range(a + 1):
                total = 0.0
                for f in range(frames):
                    total += r[a, f, 0] * r[b, f, 0] + r[a, f, 1] * r[b, f, 1] + r[a, f, 2] * r[b, f, 2]
                E[a, b] = total
        first, second, share, least, single = 0, 0, 1.0, np.inf, np.inf
        for a in range(count):
            if E[a, a] < single:
                single = E[a, a]
                heir[v] = other[a]
            if E[a, a] < least:
                first, second, share, least = a, a, 1.0, E[a, a]
            for b in range(a):
                bend = E[a, a] - 2.0 * E[a, b] + E[b, b]
                if bend <= 0.0:
                    continue
                w = (E[b, b] - E[a, b]) / bend
                if 0.0 < w < 1.0 and E[b, b] - w * w * bend < least:
                    first, second, share, least = a, b, w, E[b, b] - w * w * bend
        for f in range(frames):
            for i in range(3):
                left = share * r[first, f, i] + (1.0 - share) * r[second, f, i]
                loss[f] += area[v] * (left * left - own[f, i] * own[f, i])
            mass[f] += area[v] * weight[f, v]
    full = max(mass.max(), 1e-300)
    total, frames_seen = 0.0, 0.0
    for f in range(frames):
        seen = mass[f] / full
        if mass[f] > 0.0:
            total += seen * max(loss[f] / mass[f], 0.0) ** 2
        frames_seen += seen
    return (total / max(frames_seen, 1e-300)) ** 0.25


@compiled
def _left(
    V: Floats,
    N: Floats,
    x: Floats,
    weight: Floats,
    v: int,
    part: int,
    home: int,
    R: Floats,
    t: Floats,
    slip: float,
    out: Floats,
) -> None:
    """Writes (frame, xyz) √w · what a part's motion leaves of a vertex's; along the surface as it stands in `home`, less."""
    for f in range(x.shape[0]):
        n0 = n1 = n2 = 0.0
        for j in range(3):
            n0 += R[f, home, 0, j] * N[v, j]
            n1 += R[f, home, 1, j] * N[v, j]
            n2 += R[f, home, 2, j] * N[v, j]
        r0 = t[f, part, 0] - x[f, v, 0]
        r1 = t[f, part, 1] - x[f, v, 1]
        r2 = t[f, part, 2] - x[f, v, 2]
        for j in range(3):
            r0 += R[f, part, 0, j] * V[v, j]
            r1 += R[f, part, 1, j] * V[v, j]
            r2 += R[f, part, 2, j] * V[v, j]
        across = (1.0 - slip) * (n0 * r0 + n1 * r1 + n2 * r2)
        w = np.sqrt(weight[f, v])
        out[f, 0] = w * (slip * r0 + across * n0)
        out[f, 1] = w * (slip * r1 + across * n1)
        out[f, 2] = w * (slip * r2 + across * n2)
