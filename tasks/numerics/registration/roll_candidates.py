"""Pieces of limbs tried as rigid bodies in other turns about their own axis, in one frame.

A forearm is nearly round: tracked with a soft graph it stays with the upper arm while the hand turns, and no refit brings
back a twist once lost. As a rigid body that is tried from several turns it shows which ones its surface fits; which of
them it has is seen only over many frames (`twist`).
"""

from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.geometry.rigid_fit import rigid_motion
from kinetree.tasks.numerics.registration.correspondence import Target, local_matches
from kinetree.tasks.numerics.registration.deformation import Pose
from kinetree.tasks.numerics.registration.deformation_graph import DeformationGraph
from kinetree.tasks.numerics.registration.graph_kinematics import stepped

TURNS = 12  # starts, evenly around the axis; the first is where the piece is
_LONG = 1.5  # length against width from which on a piece has an axis to turn about
_NODES, _SAMPLES, _MOST = 6, 20, 160  # a piece needs so many nodes and samples; so many samples are enough
_STEPS = 10
_SCALE = 0.003  # of the fit, share of the body's size
_JUDGED = 0.002  # of the misfit, share of the body's size
_REACH = 0.03  # share of the body's size
_BETA = 0.03  # share of the body's size
_ALIKE = 0.5
_DAMPING = 1e-2


class Limb(NamedTuple):
    """A piece that is longer than wide.

    node, sample : (row,) its nodes · (row,) vertices that stand for it
    middle, axis : (xyz) of its samples at rest, mesh unit · (xyz) unit, along it
    """

    node: Ints
    sample: Ints
    middle: Floats
    axis: Floats


class RollCandidates(NamedTuple):
    """What every limb fits in one frame: x = R (v − middle) + c.

    angle    : (limb, turn) turned about its axis from where it was, radians
    misfit   : (limb, turn) 0 where all of it lies on the surface, 1 where nothing does
    rotation : (limb, turn, 3, 3) R
    place    : (limb, turn, xyz) c, mesh unit
    """

    angle: Floats
    misfit: Floats
    rotation: Floats
    place: Floats


def limbs(graph: DeformationGraph, piece: Ints) -> list[Limb]:
    """Pieces with an axis, in their order.

    piece : (node,) see `pieces`
    """
    owner = graph.bound[graph.sample, graph.weight[graph.sample].argmax(axis=1)]
    out = []
    for number in range(int(piece.max(initial=-1)) + 1):
        node, sample = np.flatnonzero(piece == number), graph.sample[piece[owner] == number]
        if len(node) < _NODES or len(sample) < _SAMPLES:
            continue
        count = min(len(sample), _MOST)
        sample = sample[np.arange(count) * len(sample) // count]
        middle = graph.V[sample].mean(axis=0)
        _, width, axes = np.linalg.svd(graph.V[sample] - middle, full_matrices=False)
        if width[0] >= _LONG * width[1]:
            out.append(Limb(node, sample, middle, axes[0]))
    return out


def roll_candidates(graph: DeformationGraph, pose: Pose, target: Target, piece: Ints) -> RollCandidates:
    """Every limb fitted as a rigid body from each of the turns about its axis.

    pose    : of this frame, from an earlier pass
    piece   : (node,) see `pieces`
    returns : Turns; the first turn begins where the limb is
    """
    every = limbs(graph, piece)
    shape = (len(every), TURNS)
    out = RollCandidates(np.zeros(shape), np.ones(shape), np.zeros((*shape, 3, 3)), np.zeros((*shape, 3)))
    size = target.size
    limits = _BETA * size, _REACH * size, _SCALE * size, _JUDGED * size
    surface = target.V, target.N, target.start, target.ring
    for k, limb in enumerate(every):
        V, N = graph.V[limb.sample] - limb.middle, graph.N[limb.sample]
        R, c = rigid_motion(graph.g[limb.node] - limb.middle, pose.translation[limb.node])
        match = target.nearest(V @ R.T + c, N @ R.T)
        for h in range(TURNS):
            begun = R @ Rotation.from_rotvec(2.0 * np.pi * h / TURNS * limb.axis).as_matrix()
            out.rotation[k, h], out.place[k, h], out.misfit[k, h] = _iterated(V, N, begun, c, match, *surface, *limits, _STEPS)
        out.angle[k] = _about(limb.axis, R.T @ out.rotation[k])
    return out


def untwisted(graph: DeformationGraph, pose: Pose, piece: Ints, found: RollCandidates, chosen: Ints) -> Pose:
    """The pose with some limbs in another turn.

    pose    : of the frame, as it was given to `turns` with `piece`
    chosen  : (limb,) the turn each takes, −1 where it stays
    returns : Pose, in which the nodes of a limb that turned move as one; the others are as they were
    """
    R, p = pose.rotation.copy(), pose.translation.copy()
    for k, limb in enumerate(limbs(graph, piece)):
        if chosen[k] >= 0:
            turned = found.rotation[k, chosen[k]]
            R[limb.node] = turned
            p[limb.node] = (graph.g[limb.node] - limb.middle) @ turned.T + found.place[k, chosen[k]]
    return Pose(R, p)


def _about(axis: Floats, R: Floats) -> Floats:
    """(turn,) how far each rotation (turn, 3, 3) turns about an axis, radians: Procrustes in the plane across it."""
    a, b = np.linalg.svd(axis[None])[2][1:]
    sign = np.sign(np.cross(a, b) @ axis)
    sine, cosine = (b @ R @ a - a @ R @ b), (a @ R @ a + b @ R @ b)
    return np.asarray(sign * np.arctan2(sine, cosine))


@compiled
def _iterated(
    P: Floats, N: Floats, R: Floats, c: Floats, match: Ints, V: Floats, M: Floats, start: Ints, ring: Ints,
    beta: float, reach: float, scale: float, judged: float, steps: int,
) -> tuple[Floats, Floats, float]:  # fmt: skip
    """Gauss–Newton of Σ w (m·(R v + c − y))², w = (n·m) / (1 + (off / scale)²)²; R, c and the misfit."""
    turn, place = R.copy().reshape(1, 3, 3), c.copy().reshape(1, 3)
    misfit = 1.0
    for i in range(steps + 1):
        x, n = _placed(P, turn[0], place[0]), _placed(N, turn[0], np.zeros(3))
        match = local_matches(x, n, match, V, M, start, ring, beta)
        A, b, misfit = _normal_equations(x, n, place[0], V[match], M[match], reach, scale, judged)
        if i < steps:
            for block in range(2):
                mean = 0.0
                for k in range(3):
                    mean += A[3 * block + k, 3 * block + k]
                for k in range(3):
                    A[3 * block + k, 3 * block + k] += _DAMPING / 3.0 * mean + 1e-30
            turn, place = stepped(turn, place, np.linalg.solve(A, b).astype(np.float64).reshape(1, 6), 1.0)
    return turn[0], place[0], misfit


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
    """JᵀJ, −Jᵀr of a turn about c and a shift · mean misfit, 0 where a sample lies on its plane and 1 without a match.

    Planes are halfway between both normals: then matches that are not quite opposite cost nothing on a round surface.
    """
    A, b, J, misfit, half = np.zeros((6, 6)), np.zeros(6), np.empty(6), 0.0, np.empty(3)
    for i in range(len(x)):
        alike = off = square = length = 0.0
        for k in range(3):
            alike += n[i, k] * m[i, k]
            half[k] = n[i, k] + m[i, k]
            length += half[k] ** 2
            square += (x[i, k] - y[i, k]) ** 2
        if not (alike > _ALIKE and square < reach * reach):
            misfit += 1.0
            continue
        for k in range(3):
            half[k] /= np.sqrt(length)
            off += (x[i, k] - y[i, k]) * half[k]
        misfit += 1.0 - alike / (1.0 + (off / judged) ** 2)
        w = alike / (1.0 + (off / scale) ** 2) ** 2
        for k in range(3):
            k1, k2 = (k + 1) % 3, (k + 2) % 3
            J[k] = (x[i, k1] - c[k1]) * half[k2] - (x[i, k2] - c[k2]) * half[k1]
            J[3 + k] = half[k]
        for k in range(6):
            b[k] -= w * J[k] * off
            for j in range(6):
                A[k, j] += w * J[k] * J[j]
    return A, b, max(misfit, 0.0) / len(x)
