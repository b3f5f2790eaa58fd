"""Pieces of a limb tried in other turns about their own axis, each by itself as a rigid body, where the fit is ambiguous.

A forearm is nearly round: tracked with a soft graph it stays with the upper arm while the hand turns, and no refit brings
back a twist once lost. As a rigid body that is tried from several turns it shows clearly which one its surface has.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.correspondence import Target, walked
from kinetree.tasks.numerics.deformation import Pose
from kinetree.tasks.numerics.kinematics import stepped
from kinetree.tasks.numerics.template import Template

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

TURNS = (-120.0, -80.0, -40.0, 40.0, 80.0, 120.0)  # degrees about a piece's longest axis
BETTER = 0.2  # another turn is taken if it lowers the misfit by this share
_LEAST = 0.1  # and differs by more than this, radians
_NODES, _SAMPLES, _MOST = 6, 20, 150  # a piece needs so many nodes and samples; so many samples are enough
_COARSE = (3, 0.004)  # steps, and scale as a share of the body's size
_FINE = (8, 0.003)
_FINALISTS = 2
_JUDGED = 0.002  # scale of the misfit that decides, share of the body's size
_REACH = 0.03  # share of the body's size
_BETA = 0.03  # share of the body's size
_ALIKE = 0.5
_DAMPING = 1e-3


class _Rigid(NamedTuple):
    """A piece in a frame: x = R (v − middle) + c, the matches, and the misfit, 0 to 1."""

    R: Floats
    c: Floats
    match: Ints
    misfit: float


class _Piece(NamedTuple):
    """Samples of a piece about their middle, their normals, and the frame with its lengths in the mesh's unit."""

    V: Floats
    N: Floats
    target: Target


def retried(template: Template, pose: Pose, target: Target, piece: Ints) -> Pose:
    """Every piece fitted rigidly from several turns about its longest axis; taken where it then fits clearly better.

    pose    : of this frame, from an earlier pass
    piece   : (node,) which piece each node belongs to, see `pieces`
    returns : Pose, in which the nodes of a piece that turned move as one; the others are as they were
    """
    R, p = pose.rotation.copy(), pose.translation.copy()
    owner = template.bound[template.sample, template.weight[template.sample].argmax(axis=1)]
    for number in range(int(piece.max()) + 1):
        node, sample = np.flatnonzero(piece == number), template.sample[piece[owner] == number]
        if len(node) < _NODES or len(sample) < _SAMPLES:
            continue
        sample = sample[np.arange(min(len(sample), _MOST)) * len(sample) // min(len(sample), _MOST)]
        middle = template.V[sample].mean(axis=0)
        body = _Piece(template.V[sample] - middle, template.N[sample], target)
        g = template.g[node] - middle
        better = _turned(body, *_carried(g, pose.translation[node]))
        if better is not None:
            R[node], p[node] = better.R, g @ better.R.T + better.c
    return Pose(R, p)


def _turned(body: _Piece, R: Floats, c: Floats) -> _Rigid | None:
    """The best fit from other turns, or None if the fit from where the piece is does as well."""
    target = body.target
    match = target.found(body.V @ R.T + c, body.N @ R.T)
    here = _fitted(body, _fitted(body, _Rigid(R, c, match, 1.0), _COARSE), _FINE)
    axis = np.linalg.svd(body.V, full_matrices=False)[2][0]
    turns = Rotation.from_rotvec(np.radians(TURNS)[:, None] * axis).as_matrix()
    found = [_fitted(body, _Rigid(R @ turn, c, match, 1.0), _COARSE) for turn in turns]
    found = [_fitted(body, f, _FINE) for f in sorted(found, key=lambda f: f.misfit)[:_FINALISTS]]
    best = min(found, key=lambda f: f.misfit)
    apart = float(np.trace(best.R.T @ here.R)) < 1.0 + 2.0 * np.cos(_LEAST)
    return best if apart and best.misfit < (1.0 - BETTER) * here.misfit else None


def _carried(g: Floats, p: Floats) -> tuple[Floats, Floats]:
    """The rigid motion R, c that carries g nearest to p, in least squares (Kabsch)."""
    U, _, Vt = np.linalg.svd((p - p.mean(axis=0)).T @ (g - g.mean(axis=0)))
    U[:, 2] *= np.sign(np.linalg.det(U @ Vt))
    R = U @ Vt
    return R, p.mean(axis=0) - R @ g.mean(axis=0)


def _fitted(body: _Piece, start: _Rigid, plan: tuple[int, float]) -> _Rigid:
    """Some steps of rigid point-to-plane fitting."""
    steps, scale = plan
    frame, size = body.target, body.target.size
    surface = frame.V, frame.N, frame.start, frame.ring
    limits = _BETA * size, _REACH * size, scale * size, _JUDGED * size
    return _Rigid(*_iterated(body.V, body.N, start.R, start.c, start.match, *surface, *limits, steps))


@compiled
def _iterated(
    P: Floats, N: Floats, R: Floats, c: Floats, match: Ints, V: Floats, M: Floats, start: Ints, ring: Ints,
    beta: float, reach: float, scale: float, judged: float, steps: int,
) -> tuple[Floats, Floats, Ints, float]:  # fmt: skip
    """Gauss–Newton of Σ w (m·(R v + c − y))², w = (n·m) / (1 + (off / scale)²)²; R, c, the matches and the misfit."""
    turn, place = R.copy().reshape(1, 3, 3), c.copy().reshape(1, 3)
    for i in range(steps + 1):
        x, n = _placed(P, turn[0], place[0]), _placed(N, turn[0], np.zeros(3))
        match = walked(x, n, match, V, M, start, ring, beta)
        A, b, misfit = _normal_equations(x, n, place[0], V[match], M[match], reach, scale, judged)
        if i < steps:
            for block in range(2):
                mean = 0.0
                for k in range(3):
                    mean += A[3 * block + k, 3 * block + k]
                for k in range(3):
                    A[3 * block + k, 3 * block + k] += _DAMPING * mean + 1e-30
            turn, place = stepped(turn, place, np.linalg.solve(A, b).astype(np.float64).reshape(1, 6), 1.0)
    return turn[0], place[0], match, misfit


@compiled
def _placed(P: Floats, R: Floats, c: Floats) -> Floats:
    """R v + c of every row; in this order, whatever the machine's matrix product would choose."""
    out = np.empty_like(P)
    for i in range(len(P)):
        for x in range(3):
            out[i, x] = R[x, 0] * P[i, 0] + R[x, 1] * P[i, 1] + R[x, 2] * P[i, 2] + c[x]
    return out


@compiled
def _normal_equations(
    x: Floats, n: Floats, c: Floats, y: Floats, m: Floats, reach: float, scale: float, judged: float
) -> tuple[Floats, Floats, float]:
    """JᵀJ, −Jᵀr of a turn about c and a shift · mean misfit, 0 where a sample lies on its plane and 1 without a match."""
    A, b, J, misfit = np.zeros((6, 6)), np.zeros(6), np.empty(6), 0.0
    for i in range(len(x)):
        alike = off = square = 0.0
        for k in range(3):
            alike += n[i, k] * m[i, k]
            off += (x[i, k] - y[i, k]) * m[i, k]
            square += (x[i, k] - y[i, k]) ** 2
        if not (alike > _ALIKE and square < reach * reach):
            misfit += 1.0
            continue
        misfit += 1.0 - alike / (1.0 + (off / judged) ** 2)
        w = alike / (1.0 + (off / scale) ** 2) ** 2
        for k in range(3):
            k1, k2 = (k + 1) % 3, (k + 2) % 3
            J[k] = (x[i, k1] - c[k1]) * m[i, k2] - (x[i, k2] - c[k2]) * m[i, k1]
            J[3 + k] = m[i, k]
        for k in range(6):
            b[k] -= w * J[k] * off
            for j in range(6):
                A[k, j] += w * J[k] * J[j]
    return A, b, misfit / len(x)
