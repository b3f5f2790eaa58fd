"""Which part each vertex follows, and how each part moves, in turns."""

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.structure.moments import MOMENTS, motions

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Flags = npt.NDArray[np.bool_]


@compiled
def misfit(V: Floats, x: Floats, weight: Floats, R: Floats, t: Floats, label: Ints) -> Floats:
    """Mean over frames of |R q + t − x|² under the motion of each vertex's own part, e(v) = Σ_t w r² / Σ_t w.

    V, x    : (vertex, xyz) · (frame, vertex, xyz) mesh unit
    weight  : (frame, vertex) belief, 0 to 1
    R, t    : (frame, part, 3, 3) · (frame, part, xyz)
    label   : (vertex,) part, −1 for none
    returns : (vertex,) mesh unit²; 0 without a part or a frame
    """
    total, mass = np.zeros(len(label)), np.zeros(len(label))
    for f in range(x.shape[0]):
        for v in range(len(label)):
            p = label[v]
            if p < 0:
                continue
            for i in range(3):
                r = t[f, p, i] - x[f, v, i]
                for j in range(3):
                    r += R[f, p, i, j] * V[v, j]
                total[v] += weight[f, v] * r * r
            mass[v] += weight[f, v]
    for v in range(len(label)):
        if mass[v] > 0.0:
            total[v] /= mass[v]
    return total


@compiled
def residuals(V: Floats, x: Floats, weight: Floats, R: Floats, t: Floats, label: Ints) -> Floats:
    """Root mean square of |R q + t − x| over each part's vertices, in every frame.

    weight  : (frame, vertex) not negative
    returns : (frame, part) mesh unit; 0 for a part of no weight
    """
    total, mass = np.zeros(R.shape[:2]), np.zeros(R.shape[:2])
    for f in range(x.shape[0]):
        for v in range(len(label)):
            p = label[v]
            for i in range(3):
                r = t[f, p, i] - x[f, v, i]
                for j in range(3):
                    r += R[f, p, i, j] * V[v, j]
                total[f, p] += weight[f, v] * r * r
            mass[f, p] += weight[f, v]
    return np.sqrt(total / np.maximum(mass, 1e-300))


@compiled
def fitted(
    V: Floats, x: Floats, weight: Floats, area: Floats, label: Ints, asked: Flags, R: Floats, t: Floats, floor: float
) -> None:
    """Writes the motions of the asked parts from their clearly rigid vertices: w = (s² / (s² + e))², s² the median of e.

    area    : (vertex,) mesh unit²
    asked   : (part,)
    R, t    : (frame, part, 3, 3) · (frame, part, xyz), written
    floor   : least s², mesh unit²
    """
    number = np.full(len(asked), -1, np.int64)
    count = 0
    for p in range(len(asked)):
        if asked[p]:
            number[p] = count
            count += 1
    size = 0
    for v in range(len(label)):
        size += label[v] >= 0 and number[label[v]] >= 0
    at = np.empty(size, np.int64)
    own = np.empty(size, np.int64)
    k = 0
    for v in range(len(label)):
        if label[v] >= 0 and number[label[v]] >= 0:
            at[k], own[k] = v, number[label[v]]
            k += 1
    frames = x.shape[0]
    sure = np.ones(size)
    Rp, tp = np.empty((frames, count, 3, 3)), np.empty((frames, count, 3))
    for turn in range(3):
        M = np.zeros((count, frames, MOMENTS))
        for f in range(frames):
            for k in range(size):
                v, p = at[k], own[k]
                w = sure[k] * area[v] * (weight[f, v] + 1e-6)
                square = 0.0
                M[p, f, 0] += w
                for i in range(3):
                    q, y = w * V[v, i], x[f, v, i]
                    square += q * V[v, i] + w * y * y
                    M[p, f, 1 + i] += q
                    M[p, f, 4 + i] += w * y
                    for j in range(3):
                        M[p, f, 8 + 3 * i + j] += q * x[f, v, j]
                M[p, f, 7] += square
        Rp, tp = motions(M)
        if turn == 2:
            break
        e = np.zeros(size)
        mass = np.zeros(size)
        for f in range(frames):
            for k in range(size):
                v, p = at[k], own[k]
                for i in range(3):
                    r = tp[f, p, i] - x[f, v, i]
                    for j in range(3):
                        r += Rp[f, p, i, j] * V[v, j]
                    e[k] += weight[f, v] * r * r
                mass[k] += weight[f, v]
        for k in range(size):
            e[k] /= max(mass[k], 1e-6)
        for p in range(count):
            s2 = max(np.median(e[own == p]), floor)
            for k in range(size):
                if own[k] == p:
                    sure[k] = (s2 / (s2 + e[k])) ** 2
    for p in range(len(asked)):
        if number[p] >= 0:
            R[:, p] = Rp[:, number[p]]
            t[:, p] = tp[:, number[p]]


def relabelled(
    V: Floats,
    x: Floats,
    weight: Floats,
    R: Floats,
    t: Floats,
    label: Ints,
    start: Ints,
    ring: Ints,
    steps: int,
) -> Ints:
    """Every vertex given to the part, of those near, whose motion explains its surroundings best.

    R, t        : (frame, part, 3, 3) · (frame, part, xyz)
    label       : (vertex,) part before
    start, ring : neighbours of every vertex, see `rings.rings`
    steps       : means over a vertex and its neighbours that the misfits go through: how far the surroundings reach
    returns     : (vertex,) part; what is cut off from the bulk of its part goes to those around it
    """
    parts = R.shape[1]
    near = neighbouring(label, parts, start, ring)
    E = _misfits(V, x, weight, R, t, label, near)
    for _ in range(steps):
        E = _averaged(E, start, ring)
    best: Ints = np.where(label >= 0, np.argmin(E, axis=1), label)
    return connected(best, parts, start, ring)


@compiled
def neighbouring(label: Ints, parts: int, start: Ints, ring: Ints) -> Ints:
    """(part, part) edges of the mesh between any two parts; each counted once from either side."""
    near = np.zeros((parts, parts), np.int64)
    for v in range(len(label)):
        for q in range(start[v], start[v + 1]):
            a, b = label[v], label[ring[q]]
            if a != b and a >= 0 and b >= 0:
                near[a, b] += 1
    return near


@compiled
def _misfits(V: Floats, x: Floats, weight: Floats, R: Floats, t: Floats, label: Ints, near: Ints) -> Floats:
    """(vertex, part) mean squared residual, of a vertex's own part and those next to it; far larger for all others."""
    parts = len(near)
    E = np.full((len(label), parts), np.inf)
    away = 0.0
    for v in range(len(label)):
        a = label[v]
        if a < 0:
            continue
        mass = 0.0
        for f in range(x.shape[0]):
            mass += weight[f, v]
        for p in range(parts):
            if p != a and near[a, p] == 0:
                continue
            total = 0.0
            for f in range(x.shape[0]):
                square = 0.0
                for i in range(3):
                    r = t[f, p, i] - x[f, v, i]
                    for j in range(3):
                        r += R[f, p, i, j] * V[v, j]
                    square += r * r
                total += weight[f, v] * square
            E[v, p] = total / max(mass, 1e-6)
            away = max(away, E[v, p])
    for v in range(len(label)):
        for p in range(parts):
            if np.isinf(E[v, p]):
                E[v, p] = 4.0 * away
    return E


@compiled
def _averaged(E: Floats, start: Ints, ring: Ints) -> Floats:
    out = np.empty_like(E)
    for v in range(len(E)):
        out[v] = E[v]
        for q in range(start[v], start[v + 1]):
            out[v] += E[ring[q]]
        out[v] /= 1 + start[v + 1] - start[v]
    return out


@compiled
def connected(label: Ints, parts: int, start: Ints, ring: Ints) -> Ints:
    """Every part reduced to its largest connected piece, the rest given to the labels around it, nearest first.

    returns : (vertex,) a piece with no other label around it keeps its own
    """
    piece = np.full(len(label), -1, np.int64)
    stack = np.empty(len(label), np.int64)
    largest = np.zeros(parts, np.int64)
    winner = np.full(parts, -1, np.int64)
    pieces = 0
    for seed in range(len(label)):
        if piece[seed] >= 0 or label[seed] < 0:
            continue
        top, size = 1, 0
        stack[0] = seed
        piece[seed] = pieces
        while top:
            top -= 1
            v = stack[top]
            size += 1
            for q in range(start[v], start[v + 1]):
                u = ring[q]
                if piece[u] < 0 and label[u] == label[seed]:
                    piece[u] = pieces
                    stack[top] = u
                    top += 1
        if size > largest[label[seed]]:
            largest[label[seed]] = size
            winner[label[seed]] = pieces
        pieces += 1
    out = np.full(len(label), -1, np.int64)
    count = 0
    for v in range(len(label)):
        if label[v] >= 0 and piece[v] == winner[label[v]]:
            out[v] = label[v]
            stack[count] = v
            count += 1
    done = 0
    while done < count:
        v = stack[done]
        done += 1
        for q in range(start[v], start[v + 1]):
            u = ring[q]
            if out[u] < 0 and label[u] >= 0:
                out[u] = out[v]
                stack[count] = u
                count += 1
    for v in range(len(label)):
        if out[v] < 0:
            out[v] = label[v]
    return out
