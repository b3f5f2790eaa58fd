"""How parts move: rigid motions fitted to clearly rigid vertices, and the residuals of the others (ours)."""

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.geometry.rigid_fit import MOMENTS, added, motion

ROUNDS = 3
"""Rounds of fitting and weighting anew; motions no longer change by then."""


@compiled
def squared_distance(V: Floats, x: Floats, R: Floats, t: Floats, v: int, f: int, p: int) -> float:
    """|R q + t − x|² of vertex v in frame f under the motion of part p, mesh unit²; arrays as in `misfit`."""
    total = 0.0
    for i in range(3):
        r = t[f, p, i] - x[f, v, i] + R[f, p, i, 0] * V[v, 0] + R[f, p, i, 1] * V[v, 1] + R[f, p, i, 2] * V[v, 2]
        total += r * r
    return total


@compiled
def misfit(V: Floats, x: Floats, weight: Floats, R: Floats, t: Floats, label: Ints) -> Floats:
    """Mean squared residual of each vertex under the motion of its part, e(v) = Σ_t w |R q + t − x|² / Σ_t w.

    V, x    : (vertex, xyz) · (frame, vertex, xyz) mesh unit
    weight  : (frame, vertex) confidence, 0 to 1
    R, t    : (frame, part, 3, 3) · (frame, part, xyz)
    label   : (vertex,) part
    returns : (vertex,) mesh unit²; 0 where no frame has a weight
    """
    e, mass = np.zeros(len(label)), np.zeros(len(label))
    for f in range(x.shape[0]):
        for v in range(len(label)):
            e[v] += weight[f, v] * squared_distance(V, x, R, t, v, f, label[v])
            mass[v] += weight[f, v]
    for v in range(len(label)):
        if mass[v] > 0.0:
            e[v] /= mass[v]
    return e


def rigid_share(square: Floats, removal_cost: float) -> Floats:
    """Share of motion that a part alone explains, c² / (c² + 4 e): 1 on bones, a half where √e is half of the cost c.

    square       : mean squared residual e, see `misfit`, area of the body
    removal_cost : cost from which on a part stays, root of the area
    """
    share: Floats = removal_cost**2 / (removal_cost**2 + 4 * square)
    return share


@compiled
def residuals(V: Floats, x: Floats, weight: Floats, R: Floats, t: Floats, label: Ints) -> Floats:
    """Root mean square of |R q + t − x| over each part's vertices, in every frame.

    weight  : (frame, vertex) not negative
    returns : (frame, part) mesh unit; 0 for a part of no weight
    """
    total, mass = np.zeros(t.shape[:2]), np.zeros(t.shape[:2])
    for f in range(x.shape[0]):
        for v in range(len(label)):
            total[f, label[v]] += weight[f, v] * squared_distance(V, x, R, t, v, f, label[v])
            mass[f, label[v]] += weight[f, v]
        for p in range(t.shape[1]):
            total[f, p] = np.sqrt(total[f, p] / mass[f, p]) if mass[f, p] > 0.0 else 0.0
    return total


@compiled
def fit(
    V: Floats,
    x: Floats,
    weight: Floats,
    area: Floats,
    label: Ints,
    fitted: Flags,
    warm: bool,
    most: int,
    floor: float,
    R: Floats,
    t: Floats,
) -> None:
    """Writes motions of parts from their clearly rigid vertices: each counts a · (s² / (s² + e))², s² the median of e.

    area    : (vertex,) a, mesh unit²
    label   : (vertex,) part
    fitted  : (part,) which to fit
    warm    : whether R and t hold motions to begin from: a part then stays with what it explained before
    most    : vertices that a part is fitted to; of more, evenly many
    floor   : least s², mesh unit²
    R, t    : (frame, part, 3, 3) · (frame, part, xyz), written
    """
    member = np.empty(len(label), np.int64)
    for p in range(len(fitted)):
        if not fitted[p]:
            continue
        count = members(label, p, most, member)
        if count == 0:
            continue
        sure = np.ones(count)
        for turn in range(1 if warm else ROUNDS):
            if turn > 0 or warm:
                _weigh(V, x, weight, member, count, p, R, t, floor, sure)
            for f in range(x.shape[0]):
                m = np.zeros(MOMENTS)
                for k in range(count):
                    v = member[k]
                    # a frame without any confidence still needs a motion
                    added(m, V, x, f, v, sure[k] * area[v] * (weight[f, v] + 1e-6))
                motion(m, R[f, p], t[f, p])


@compiled
def members(label: Ints, part: int, most: int, member: Ints) -> int:
    """Writes vertices of a part into `member` (vertex,), of more than `most` evenly many; returns how many."""
    total = 0
    for v in range(len(label)):
        total += label[v] == part
    count = passed = 0
    for v in range(len(label)):
        if label[v] == part:
            if passed * min(most, total) // total == count:
                member[count] = v
                count += 1
            passed += 1
    return count


@compiled
def unevenness(V: Floats, x: Floats, area: Floats, patch: Ints, label: Ints, R: Floats, t: Floats) -> Floats:
    """Distance of patches of the surface, each as a whole, from the motion of their part; noise of vertices cancels.

    patch   : (vertex,) each within one part
    returns : (patch,) root mean square over frames of a patch's mean residual, mesh unit
    """
    count = 0
    for v in range(len(patch)):
        count = max(count, patch[v] + 1)
    out, mass, total = np.zeros(count), np.zeros(count), np.zeros((count, 3))
    for v in range(len(patch)):
        mass[patch[v]] += area[v]
    for f in range(x.shape[0]):
        for k in range(count):
            for i in range(3):
                out[k] += (total[k, i] / mass[k]) ** 2 / x.shape[0]
                total[k, i] = 0.0
        for v in range(len(patch)):
            p = label[v]
            for i in range(3):
                r = t[f, p, i] - x[f, v, i] + R[f, p, i, 0] * V[v, 0] + R[f, p, i, 1] * V[v, 1] + R[f, p, i, 2] * V[v, 2]
                total[patch[v], i] += area[v] * r
    for k in range(count):
        for i in range(3):
            out[k] += (total[k, i] / mass[k]) ** 2 / x.shape[0]
        out[k] = np.sqrt(out[k])
    return out


@compiled
def _weigh(
    V: Floats, x: Floats, weight: Floats, member: Ints, count: int, p: int, R: Floats, t: Floats, floor: float, sure: Floats
) -> None:
    """Writes (member,) weights of a part's vertices by their residuals under its motion."""
    e, mass = np.zeros(count), np.full(count, 1e-6)
    for f in range(x.shape[0]):
        for k in range(count):
            v = member[k]
            e[k] += weight[f, v] * squared_distance(V, x, R, t, v, f, p)
            mass[k] += weight[f, v]
    for k in range(count):
        e[k] /= mass[k]
    scale = max(median_of(e, count), floor)
    for k in range(count):
        sure[k] = (scale / (scale + e[k])) ** 2


@compiled
def median_of(values: Floats, count: int) -> float:
    """Median of the first `count` of an array of numbers not negative, by bisection; sorting a copy compiles slowly."""
    low, high = 0.0, 0.0
    for k in range(count):
        high = max(high, values[k])
    for _ in range(50):
        half = 0.5 * (low + high)
        below = 0
        for k in range(count):
            below += values[k] <= half
        if 2 * below < count:
            low = half
        else:
            high = half
    return high
