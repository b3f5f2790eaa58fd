"""Fitting an articulated body to a sequence: rotations of all parts and the place of the root, all at once (2014, Sec. 6.3).

x_v(t) = Σ_a w_va [R_a(t) (v − rest_a) + x_a(t)], and x_j(t) = x_p(t) + R_p(t) (rest_j − rest_p) for the parent p. With
s_vj = Σ w_va over the parts a at or beyond joint j this is linear in a vertex's few numbers φ_v = (w_va v, s_vj):

    x_v(t) = x_0(t) + Σ_a R_a w_va v + Σ_j s_vj (R_p(j) − R_j) rest_j

so that a fit needs only Σ φ φᵀ and Σ x φᵀ, whatever the number of vertices. Bone lengths are the same
in all frames because the model has no others. Both sums are about the middle of the body, so that they keep their digits
wherever it lies.
"""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.compiled import compiled

DAMPING = 1e-7
"""Added to the diagonal of the normal equations, share of its mean: keeps them solvable."""
STILL = 1e-7
"""Radians by which no part turns any more when a fit ends."""


class Sums(NamedTuple):
    """The sums over vertices that a fit needs; each vertex has a vector φ of n numbers, four times the number of parts.

    G : (frame or 1, n, n) Σ τ φ φᵀ, C : (frame, xyz, n) Σ τ x φᵀ; φ is w_va v, by part, then s_vj
    origin, middle : (xyz,) · (frame, xyz) means in the reference and in the frames, from which v and x are taken, mesh unit
    """

    G: Floats
    C: Floats
    origin: Floats
    middle: Floats


class Motion(NamedTuple):
    """An articulated body in motion.

    rest : (part, xyz) the joint about which each part turns, in the reference mesh
    R    : (frame, part, 3, 3) from the reference to each frame
    x    : (frame, xyz) where the reference's origin goes with the root's part
    """

    rest: Floats
    R: Floats
    x: Floats


class PosePrior(NamedTuple):
    """Where poses are expected before a fit.

    turn : (frame, part, 3, 3) rotation R_pᵀ R_a of each part against its parent; the root's against the space around
    firm : (frame, part) how firmly it is held there, mesh unit² times the vertices' weight
    """

    turn: Floats
    firm: Floats


def beyond(parents: Ints) -> Floats:
    """(part, part) 1 where the second part is the first or lies below it, else 0; parents (part,) come before children."""
    below = np.eye(len(parents))
    for j in range(len(parents) - 1, 0, -1):
        below[parents[j]] += below[j]
    return below


def sums(V: Floats, x: Floats, W: Floats, parents: Ints, tau: Floats) -> Sums:
    """The sums over vertices that a fit needs, in every frame (ours).

    V, x : (vertex, xyz) in the reference, (frame, vertex, xyz) mesh unit
    W    : (vertex, part) skinning weights, a part after its parent
    tau  : (vertex,) weight of every vertex in all frames, or (frame, vertex)
    """
    share = tau / np.maximum(tau.sum(axis=-1, keepdims=True), np.finfo(float).tiny)
    origin = share.reshape(-1, len(V)).mean(axis=0) @ V
    middle = np.einsum("tv,tvx->tx", np.broadcast_to(share, x.shape[:2]), x)
    V, x = V - origin, x - middle[:, None]
    phi = np.concatenate([(W[:, :, None] * V[:, None]).reshape(len(V), -1), W @ beyond(parents).T], axis=1)
    if tau.ndim == 1:
        weighted = tau[:, None] * phi
        rows = np.ascontiguousarray(x.transpose(0, 2, 1)).reshape(-1, len(V))
        return Sums((phi.T @ weighted)[None], (rows @ weighted).reshape(len(x), 3, -1), origin, middle)
    row, place = np.nonzero(phi)
    start = np.searchsorted(row, np.arange(len(phi) + 1))
    x, tau, value = np.ascontiguousarray(x), np.ascontiguousarray(tau), phi[row, place]
    return Sums(*_sums(start, np.ascontiguousarray(place), value, x, tau, phi.shape[1]), origin, middle)


def fitted(s: Sums, start: Motion, parents: Ints, expected: PosePrior | None = None, *, rounds: int = 10) -> Motion:
    """The poses of least error, Σ τ |x − x̂|² + Σ firm |log|², by Gauss–Newton; the joints stay (2014, Sec. 6.3).

    s        : sums over the vertices
    start    : joints, and poses to start from
    parents  : (part,) −1 for the root
    expected : where poses are held; nowhere if not given
    rounds   : at most; it ends earlier when nothing turns any more
    """
    motion = Motion(start.rest - s.origin, start.R, start.x + start.R[:, 0] @ s.origin - s.middle)
    levers = _levers(motion.rest, parents)
    for _ in range(rounds):
        H, g = _normal_equations(s, motion, parents, levers)
        if expected is not None:
            _hold(H, g, motion.R, parents, expected)
        diagonal = np.arange(H.shape[1])
        H[:, diagonal, diagonal] += DAMPING * np.trace(H, axis1=1, axis2=2)[:, None] / len(diagonal)
        move = np.linalg.solve(H, g[..., None])[..., 0]
        omega = np.asarray(move[:, :-3].reshape(*motion.R.shape[:2], 3), dtype=np.float64)
        motion = Motion(motion.rest, rotations(omega) @ motion.R, motion.x + move[:, -3:])
        if np.abs(omega).max(initial=0.0) < STILL:
            break
    return Motion(start.rest, motion.R, motion.x + s.middle - motion.R[:, 0] @ s.origin)


def placed(motion: Motion, parents: Ints) -> Floats:
    """(frame, part, xyz) the joints, x_j = x_p + R_p (rest_j − rest_p), mesh unit; parents (part,) −1 for the root."""
    X = np.empty((*motion.R.shape[:2], 3))
    X[:, 0] = motion.x + motion.R[:, 0] @ motion.rest[0]
    for j in range(1, len(parents)):
        p = parents[j]
        X[:, j] = X[:, p] + motion.R[:, p] @ (motion.rest[j] - motion.rest[p])
    return X


def predicted(V: Floats, W: Floats, motion: Motion, parents: Ints) -> Floats:
    """(frame, vertex, xyz) where linear blend skinning puts the surface, mesh unit.

    V, W    : (vertex, xyz) reference, mesh unit · (vertex, part) skinning weights
    parents : (part,) −1 for the root
    """
    T, P = motion.R.shape[:2]
    t = placed(motion, parents) - np.einsum("tpxy,py->tpx", motion.R, motion.rest)
    phi = np.concatenate([(W[:, :, None] * V[:, None]).reshape(len(V), -1), W], axis=1)
    theta = np.concatenate([motion.R.transpose(0, 2, 1, 3).reshape(T, 3, 3 * P), t.transpose(0, 2, 1)], axis=2)
    return (theta.reshape(-1, 4 * P) @ phi.T).reshape(T, 3, len(V)).transpose(0, 2, 1)


def _normal_equations(s: Sums, motion: Motion, parents: Ints, levers: Floats) -> tuple[Floats, Floats]:
    """(frame, m, m) and (frame, m): rotation vectors of all parts, then the shift."""
    T, P = motion.R.shape[:2]
    held = np.einsum("tpxy,py->tpx", motion.R[:, parents] - motion.R, motion.rest)
    held[:, 0] = motion.x
    theta = np.concatenate([motion.R.transpose(0, 2, 1, 3).reshape(T, 3, 3 * P), held.transpose(0, 2, 1)], axis=2)
    error = s.C - theta @ s.G
    Z = np.einsum("tpxy,pyn->tpxn", motion.R, levers).reshape(T, 3 * P, -1)
    ZG = Z @ s.G
    S = (ZG @ Z.transpose(0, 2, 1)).reshape(T, P, 3, P, 3)
    trace = np.einsum("tpxqx->tpq", S)
    H = np.empty((T, 3 * P + 3, 3 * P + 3))
    H[:, :-3, :-3] = (np.einsum("tpq,xy->tpxqy", trace, np.eye(3)) - S.transpose(0, 1, 4, 3, 2)).reshape(T, 3 * P, 3 * P)
    H[:, :-3, -3:] = _crossing(ZG[:, :, 3 * P].reshape(T, P, 3)).reshape(T, 3 * P, 3)
    H[:, -3:, :-3] = H[:, :-3, -3:].transpose(0, 2, 1)
    H[:, -3:, -3:] = s.G[:, 3 * P, 3 * P, None, None] * np.eye(3)
    torque = _axial((Z @ error.transpose(0, 2, 1)).reshape(T, P, 3, 3))
    return H, np.concatenate([torque.reshape(T, -1), error[:, :, 3 * P]], axis=1)


@compiled
def _sums(start: Ints, place: Ints, value: Floats, x: Floats, tau: Floats, size: int) -> tuple[Floats, Floats]:
    """(frame, n, n) · (frame, xyz, n) as in `Sums`: a vertex follows few parts, so that most of its φ is 0.

    start, place, value : (vertex + 1,) · (entry,) · (entry,) what of φ is not 0, vertex by vertex
    """
    G, C = np.zeros((len(x), size, size)), np.zeros((len(x), 3, size))
    for f in range(len(x)):
        for v in range(len(start) - 1):
            for a in range(start[v], start[v + 1]):
                p, weighted = place[a], tau[f, v] * value[a]
                for k in range(3):
                    C[f, k, p] += weighted * x[f, v, k]
                for b in range(a, start[v + 1]):
                    G[f, p, place[b]] += weighted * value[b]
        for p in range(size):
            for q in range(p):
                G[f, p, q] = G[f, q, p]
    return G, C


def _levers(rest: Floats, parents: Ints) -> Floats:
    """(part, xyz, n) U with x_v = x_0 + Σ_a R_a U_a φ_v: what each part's rotation carries of a vertex."""
    P = len(parents)
    U = np.zeros((P, 3, 4 * P))
    for a in range(P):
        U[a, :, 3 * a : 3 * a + 3] = np.eye(3)
        if a:
            U[a, :, 3 * P + a] -= rest[a]
            U[parents[a], :, 3 * P + a] += rest[a]
    return U


def _hold(H: Floats, g: Floats, R: Floats, parents: Ints, expected: PosePrior) -> None:
    """Adds firm |log(R_p turn R_aᵀ)|² for every part a."""
    above = R[:, parents].copy()
    above[:, 0] = np.eye(3)
    away = -_axial(above @ expected.turn @ R.transpose(0, 1, 3, 2)) / 2
    for a in range(R.shape[1]):
        i, j = slice(3 * a, 3 * a + 3), slice(3 * int(parents[a]), 3 * int(parents[a]) + 3)
        block = expected.firm[:, a, None, None] * np.eye(3)
        H[:, i, i] += block
        g[:, i] += expected.firm[:, a, None] * away[:, a]
        if a:
            H[:, j, j] += block
            H[:, i, j] -= block
            H[:, j, i] -= block
            g[:, j] -= expected.firm[:, a, None] * away[:, a]


def _axial(N: Floats) -> Floats:
    """(…, 3) Σ p × q of N = Σ p qᵀ."""
    return np.stack([N[..., 1, 2] - N[..., 2, 1], N[..., 2, 0] - N[..., 0, 2], N[..., 0, 1] - N[..., 1, 0]], axis=-1)


def _crossing(p: Floats) -> Floats:
    """(…, 3, 3) the matrix of p ×."""
    K = np.zeros((*p.shape, 3))
    K[..., 0, 1], K[..., 1, 2], K[..., 2, 0] = -p[..., 2], -p[..., 0], -p[..., 1]
    K[..., 0, 2], K[..., 1, 0], K[..., 2, 1] = p[..., 1], p[..., 2], p[..., 0]
    return K


def rotations(omega: Floats) -> Floats:
    """Rotations by vectors, ω (…, 3) in radians; (…, 3, 3) (Rodrigues)."""
    angle = np.maximum(np.linalg.norm(omega, axis=-1)[..., None, None], 1e-12)
    K = _crossing(omega)
    R: Floats = np.eye(3) + np.sin(angle) / angle * K + (1 - np.cos(angle)) / angle**2 * (K @ K)
    return R
