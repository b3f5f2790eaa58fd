"""Deforming an initial model to the graph of another frame by external and internal forces (2009, Sec. 2.3.1, Eqs. 2 to 4).

External forces drift nodes towards the nearest nodes of the target, in both directions (Burr 1981); internal forces hold the
nodes within two hops together. Motion is integrated by the backward Euler method, whose systems are linear here: forces are
taken where a step begins, stiffness where it ends.
"""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints


class Forces(NamedTuple):
    """How a model is drawn and held; lengths are shares of the body's size.

    sigma       : σ of Eq. 3
    stiffness   : k of Eq. 4, of one hop; two hops have half of it
    anchor      : k′ of Eq. 4
    step        : of time
    steps       : most steps
    damping     : share of the velocity that a step takes off
    rest_length : whether internal forces keep the distances of the model at rest; Eq. 4 to the letter shortens all of them
    centred     : whether −k′ q pulls to the model's place before, and not to the origin
    """

    sigma: float = 0.05
    stiffness: float = 1.0
    anchor: float = 0.02
    step: float = 1.0
    steps: int = 40
    damping: float = 0.5
    rest_length: bool = True
    centred: bool = True


def external_forces(P: Floats, a: Floats, target: Floats, source: Floats, b: Floats, sigma: float) -> Floats:
    """(point, xyz) Σ α f(a) / Σ α + Σ β f(b) / Σ β, with α = exp(−|p − a| / σ)  (Eqs. 2, 3, in three dimensions).

    P         : (point, xyz) at which the force works
    a, target : (pair, xyz) nodes of the model and the target's nodes nearest to them, which they drift to
    source, b : (pair, xyz) nodes of the model that are nearest to the target's nodes b, which they drift to
    sigma     : mesh unit
    """
    out: Floats = np.zeros_like(P)
    for start, drift in ((a, target - a), (source, b - source)):
        if len(start):
            d = np.linalg.norm(P[:, None] - start[None], axis=2)
            alpha = np.exp(-(d - d.min(axis=1, keepdims=True)) / sigma)  # the least distance cancels in the quotient
            out += alpha @ drift / alpha.sum(axis=1, keepdims=True)
    return out


def two_hops(parents: Ints) -> tuple[Ints, Floats]:
    """(pair, 2) nodes within two hops of a tree, each pair once · (pair,) 1 for one hop, ½ for two."""
    one = [(int(p), n) for n, p in enumerate(parents) if p >= 0]
    near: list[list[int]] = [[] for _ in parents]
    for a, b in one:
        near[a].append(b)
        near[b].append(a)
    two = sorted({(min(a, b), max(a, b)) for n in range(len(parents)) for a in near[n] for b in near[n] if a < b})
    pair = np.array(one + two, np.int64).reshape(-1, 2)
    return pair, np.concatenate([np.ones(len(one)), np.full(len(two), 0.5)])


def internal_forces(q: Floats, pair: Ints, stiffness: Floats, length: Floats) -> Floats:
    """(node, xyz) Σ k (|q_j − q| − L) (q_j − q) / |q_j − q| over the nodes within two hops  (Eq. 4; L = 0 to the letter).

    pair, stiffness, length : (pair, 2) · (pair,) k · (pair,) L, mesh unit
    """
    d = q[pair[:, 1]] - q[pair[:, 0]]
    now = np.maximum(np.linalg.norm(d, axis=1), np.finfo(float).tiny)
    pull = (stiffness * (now - length) / now)[:, None] * d
    out = np.zeros_like(q)
    np.add.at(out, pair[:, 0], pull)
    np.add.at(out, pair[:, 1], -pull)
    return out


def deformed_graph(
    rest: Floats,
    parents: Ints,
    q: Floats,
    target: Floats,
    size: float,
    forces: Forces,
    pulled: Ints | None = None,
    towards: Floats | None = None,
) -> Floats:
    """(node, xyz) the model drawn to a target by the forces, integrated by the backward Euler method.

    rest, parents   : (node, xyz) mesh unit · (node,) the model
    q               : (node, xyz) where it starts
    target          : (target node, xyz) mesh unit
    size            : root of the body's area, mesh unit
    pulled, towards : (pull,) nodes that drift to a place of their own · (pull, xyz); they take no part in Eq. 2
    """
    pair, k = two_hops(parents)
    k = forces.stiffness * k
    length = np.linalg.norm(rest[pair[:, 0]] - rest[pair[:, 1]], axis=1) if forces.rest_length else np.zeros(len(pair))
    count, h = len(rest), forces.step
    L = np.zeros((count, count))
    np.add.at(L, (pair.ravel(), pair.ravel()), np.repeat(k, 2))
    np.add.at(L, (pair, pair[:, ::-1]), -np.repeat(k, 2).reshape(-1, 2))
    L += (1.0 + forces.anchor) * np.eye(count)
    inverse = np.linalg.inv((1.0 + h * forces.damping) * np.eye(count) + h * h * L)
    home = q.copy() if forces.centred else np.zeros_like(q)
    x, v = q.copy(), np.zeros_like(q)
    for _ in range(forces.steps):
        f = _drawn(x, target, forces.sigma * size, pulled, towards)
        f += internal_forces(x, pair, k, length) - forces.anchor * (x - home)
        v = inverse @ (v + h * f)
        x = x + h * v
        if np.abs(v).max(initial=0.0) * h < 1e-4 * size:
            break
    return x


def _drawn(x: Floats, target: Floats, sigma: float, pulled: Ints | None, towards: Floats | None) -> Floats:
    """(node, xyz) external forces."""
    free = np.ones(len(x), np.bool_)
    out = np.zeros_like(x)
    if pulled is not None and towards is not None:
        free[pulled] = False
        out[pulled] = towards - x[pulled]
    if free.any() and len(target):
        d = np.linalg.norm(x[free][:, None] - target[None], axis=2)
        near, back = target[d.argmin(axis=1)], x[free][d.argmin(axis=0)]
        out[free] = external_forces(x[free], x[free], near, back, target, sigma) / 2
    return out


def along_branches(
    rest: Floats, parents: Ints, branch: Ints, end: Ints, leaf: Ints, lines: list[Floats]
) -> tuple[Ints, Floats]:
    """(pull,) nodes of the model's branches · (pull, xyz) the points of the target's branches as far from the leaf (ours).

    rest, parents, branch, end : of the model, see `GraphBody`
    leaf    : (target branch,) leaf of the model that each is, −1 for none
    lines   : of each target branch its nodes (point, xyz) from the leaf inwards, mesh unit
    """
    nodes, places = [], []
    for number, line in zip(leaf.tolist(), lines, strict=True):
        if number < 0 or len(line) < 2:
            continue
        n, far = int(end[number]), 0.0
        reach = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
        while n >= 0 and branch[n] == number and far <= reach[-1]:
            nodes.append(n)
            places.append([np.interp(far, reach, line[:, x]) for x in range(3)])
            far += float(np.linalg.norm(rest[n] - rest[parents[n]])) if parents[n] >= 0 else 0.0
            n = int(parents[n])
    return np.array(nodes, np.int64), np.array(places).reshape(-1, 3)


def least_turns(rest: Floats, parents: Ints, R: Floats, x: Floats) -> Floats:
    """(node, 3, 3) rotations that carry the model's bones to where its nodes are, turned no more than they must be.

    rest, parents : (node, xyz) · (node,)
    R             : (node, 3, 3) rotations before, whose twist is kept
    x             : (node, xyz) nodes now, mesh unit
    """
    out = R.copy()
    near: list[list[int]] = [[int(p)] if p >= 0 else [] for p in parents]
    for n, p in enumerate(parents):
        if p >= 0:
            near[p].append(n)
    out[0] = _kabsch(rest[near[0]] - rest[0], x[near[0]] - x[0], R[0])
    for n in range(1, len(parents)):
        p = parents[n]
        away = [m for m in near[n] if m != p]
        ahead = away if len(away) == 1 else [n]
        a = R[n] @ (rest[ahead[0]] - rest[p])
        b = x[ahead[0]] - x[p]
        out[n] = _least_turn(a, b) @ R[n]
    return out


def _kabsch(a: Floats, b: Floats, R: Floats) -> Floats:
    """(3, 3) the rotation of a (point, xyz) nearest to b; held near R, for few points do not determine it."""
    A = a @ R.T
    M = b.T @ A + 0.1 * float((A**2).sum()) * np.eye(3)
    U, _, W = np.linalg.svd(M)
    S = np.diag([1.0, 1.0, float(np.sign(np.linalg.det(U @ W)))])
    return np.asarray(U @ S @ W @ R, dtype=np.float64)


def _least_turn(a: Floats, b: Floats) -> Floats:
    """(3, 3) the rotation by the least angle that takes direction a to direction b."""
    a, b = a / max(float(np.linalg.norm(a)), 1e-300), b / max(float(np.linalg.norm(b)), 1e-300)
    v, c = np.cross(a, b), float(a @ b)
    if c < -0.999:
        return np.eye(3)
    K = np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])
    return np.asarray(np.eye(3) + K + K @ K / (1.0 + c), dtype=np.float64)
