"""Smooth skinning weights from labels and motion: at most four parts a vertex, not negative, summing to one.

Least squares over the part of the vertex and its neighbours in the tree, held near the weights of the surface around
(after Le and Deng 2014): where the motion does not determine them, the surface does.
"""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.geometry.neighbours import rings

INFLUENCES = 4
"""Parts that a vertex follows, at most: what glTF and game engines take."""


class SkinningSettings(NamedTuple):
    """How weights are found."""

    least_weight: float = 0.01
    """A smaller weight is none. Not recorded."""
    rounds: int = 3
    """Rounds of smoothing and fitting. Not recorded."""


def candidates(label: Ints, parents: Ints) -> Ints:
    """(part, slot) each part itself, its parent and its children, −1 where there are no more.

    parents : (part,) −1 at the root
    """
    near = [
        [p] + ([int(parents[p])] if parents[p] >= 0 else []) + np.flatnonzero(parents == p).tolist()
        for p in range(len(parents))
    ]
    slots = max(len(row) for row in near)
    return np.array([row + [-1] * (slots - len(row)) for row in near], dtype=np.int64)


def skinning(
    V: Floats, F: Ints, x: Floats, label: Ints, R: Floats, t: Floats, parents: Ints, tau: Floats, noise: float,
    settings: SkinningSettings | None = None,
) -> Floats:  # fmt: skip
    """Skinning weights of at most four parts a vertex (after Le and Deng 2014).

    V, x    : (vertex, xyz) in the reference, (frame, vertex, xyz) mesh unit
    F       : (face, corner)
    label   : (vertex,) part that a vertex moves with most
    R, t    : (frame, part, 3, 3), (frame, part, xyz) from the reference to each frame
    parents : (part,) −1 at the root
    tau     : (frame, vertex) weight of what was seen
    noise   : error of a vertex below which its motion says nothing, mesh unit
    returns : (vertex, part) rows summing to 1
    """
    chosen = settings or SkinningSettings()
    near = candidates(label, parents)
    H, g = grams(V, x, R, t, label, near, tau)
    start, ring = rings(F, len(V))
    W = np.zeros((len(V), near.shape[1]))
    W[:, 0] = 1.0
    hold, count = np.full(len(V), noise**2), (near >= 0).sum(axis=1)[label]
    for _ in range(chosen.rounds):
        around = _smoothed(W, label, near, start, ring)
        W = on_simplex(H, g, hold, around, count)
    dense = np.zeros((len(V), len(parents)))
    slots = near[label]
    for k in range(near.shape[1]):
        there = slots[:, k] >= 0
        dense[there, slots[there, k]] += W[there, k]
    return few(dense, chosen.least_weight)


def few(W: Floats, least: float = 0.01) -> Floats:
    """The heaviest four weights of each vertex, without those below `least`, summing to 1; (vertex, part)."""
    if W.shape[1] > INFLUENCES:
        fourth = np.partition(W, -INFLUENCES, axis=1)[:, -INFLUENCES]
        W = np.where(np.maximum(fourth, least)[:, None] <= W, W, 0.0)
    else:
        W = np.where(least <= W, W, 0.0)
    return W / W.sum(axis=1, keepdims=True)


def heaviest(W: Floats) -> tuple[Ints, Floats]:
    """(vertex, 4) parts, heaviest first · (vertex, 4) their weights, from W (vertex, part); 0 of part 0 where fewer."""
    order = np.argsort(-W, axis=1, kind="stable")[:, :INFLUENCES]
    weight = np.take_along_axis(W, order, axis=1)
    order = np.where(weight > 0, order, 0)
    missing = INFLUENCES - order.shape[1]
    return np.pad(order, ((0, 0), (0, max(missing, 0)))), np.pad(weight, ((0, 0), (0, max(missing, 0))))


@compiled
def grams(V: Floats, x: Floats, R: Floats, t: Floats, label: Ints, near: Ints, tau: Floats) -> tuple[Floats, Floats]:
    """Per vertex the mean over frames of (y_k − y_0)·(y_l − y_0) and (x − y_0)·(y_k − y_0), y_k as the k-th candidate goes.

    V, x    : (vertex, xyz), (frame, vertex, xyz) mesh unit
    R, t    : (frame, part, 3, 3), (frame, part, xyz) from the reference to each frame
    label   : (vertex,) row of `near` in which its candidates stand
    near    : (label, slot) parts, −1 where there are no more
    tau     : (frame, vertex) weight of what was seen
    returns : (vertex, slot, slot) · (vertex, slot) mesh unit²
    """
    slots = near.shape[1]
    H, g = np.zeros((len(V), slots, slots)), np.zeros((len(V), slots))
    d = np.zeros((slots, 3))
    for v in range(len(V)):
        a = label[v]
        mass = 1e-12
        for f in range(len(x)):
            w = tau[f, v]
            mass += w
            for k in range(slots):
                p = near[a, k]
                if p < 0:
                    break
                for i in range(3):
                    d[k, i] = R[f, p, i, 0] * V[v, 0] + R[f, p, i, 1] * V[v, 1] + R[f, p, i, 2] * V[v, 2] + t[f, p, i]
            r0, r1, r2 = x[f, v, 0] - d[0, 0], x[f, v, 1] - d[0, 1], x[f, v, 2] - d[0, 2]
            for k in range(1, slots):
                if near[a, k] < 0:
                    break
                for i in range(3):
                    d[k, i] -= d[0, i]
                g[v, k] += w * (d[k, 0] * r0 + d[k, 1] * r1 + d[k, 2] * r2)
                for m in range(1, k + 1):
                    H[v, k, m] += w * (d[k, 0] * d[m, 0] + d[k, 1] * d[m, 1] + d[k, 2] * d[m, 2])
        for k in range(slots):
            g[v, k] /= mass
            for m in range(k + 1):
                H[v, k, m] /= mass
                H[v, m, k] = H[v, k, m]
    return H, g


@compiled
def _smoothed(W: Floats, label: Ints, near: Ints, start: Ints, ring: Ints) -> Floats:
    """Mean of the weights around each vertex, as far as they are of its own candidates."""
    out = np.zeros_like(W)
    slots = W.shape[1]
    for v in range(len(W)):
        total = 0.0
        for e in range(start[v], start[v + 1]):
            u = ring[e]
            for m in range(slots):
                p = near[label[u], m]
                if p < 0:
                    break
                for k in range(slots):
                    if near[label[v], k] == p:
                        out[v, k] += W[u, m]
                        total += W[u, m]
        for k in range(slots):
            out[v, k] = out[v, k] / total if total > 0 else W[v, k]
    return out


@compiled
def on_simplex(H: Floats, g: Floats, hold: Floats, around: Floats, count: Ints) -> Floats:
    """The least of wᵀHw − 2gᵀw + hold |w − around|² over w ≥ 0, Σ w = 1: weight handed from one candidate to another.

    H, g    : see `grams`
    hold    : (vertex,) mesh unit²
    around  : (vertex, slot) weights to begin from, not negative, summing to 1
    count   : (vertex,) candidates that it has, in the first slots
    returns : (vertex, slot)
    """
    slots = H.shape[1]
    out = around.copy()
    for v in range(len(H)):
        w = out[v]
        for _ in range(30):
            moved = 0.0
            for k in range(count[v]):
                for m in range(k):
                    slope, bend = 0.0, H[v, k, k] + H[v, m, m] - 2 * H[v, k, m] + 2 * hold[v]
                    for i in range(slots):
                        slope += (H[v, k, i] - H[v, m, i]) * w[i]
                    slope += hold[v] * (w[k] - around[v, k] - w[m] + around[v, m]) - g[v, k] + g[v, m]
                    step = min(max(-slope / bend, -w[k]), w[m]) if bend > 0 else 0.0
                    w[k] += step
                    w[m] -= step
                    moved = max(moved, abs(step))
            if moved < 1e-4:
                break
    return out
