"""Limbs fitted as rigid bodies from several rolls about their own axis, in one frame (ours).

A forearm is nearly round: tracked with a soft graph it stays with the upper arm while the hand turns, and no refit brings
lost roll back. Fitted as a rigid body from several starts, it shows which rolls its surface allows; which of them is right is
decided over many frames (`roll`).
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


class RollCandidatesSettings(NamedTuple):
    """Which clusters are limbs with an axis, and how each is fitted from every start. Chosen on: not recorded."""

    starts: int = 12
    """Starts, evenly around the axis; the first is where the limb is."""
    elongation: float = 1.5
    """Length over width from which on a cluster has an axis."""
    nodes: int = 6
    """Nodes that a limb has at least."""
    samples: int = 20
    """Samples that a limb has at least."""
    most_samples: int = 160
    """Samples of a limb that are used at most."""
    steps: int = 10
    """Gauss–Newton steps of each fit."""
    scale: float = 0.003
    """Distance from the plane at which a match counts a quarter in the fit, share of √area."""
    misfit_scale: float = 0.002
    """Distance from the plane at which a sample counts a half in the misfit, share of √area."""
    reach: float = 0.03
    """Matches farther apart do not count, share of √area."""
    beta: float = 0.03
    """β of the matches, share of √area."""
    cosine: float = 0.5
    """Matches whose normals have a smaller cosine do not count."""
    damping: float = 1e-2
    """Added to the diagonal of the normal equations, share of its mean."""


class Limb(NamedTuple):
    """A rigid cluster that is longer than wide.

    node, sample : (row,) its nodes · (row,) samples that stand for it
    middle, axis : (xyz) of its samples at rest, mesh unit · (xyz) unit, along it
    """

    node: Ints
    sample: Ints
    middle: Floats
    axis: Floats


class RollCandidates(NamedTuple):
    """What every limb fits in one frame: x = R (v − middle) + c.

    angle    : (limb, candidate) roll about its axis from where it was, radians
    misfit   : (limb, candidate) 0 where all of it lies on the surface, 1 where nothing does
    rotation : (limb, candidate, 3, 3) R
    place    : (limb, candidate, xyz) c, mesh unit
    """

    angle: Floats
    misfit: Floats
    rotation: Floats
    place: Floats


def limbs(graph: DeformationGraph, cluster: Ints, settings: RollCandidatesSettings | None = None) -> list[Limb]:
    """Rigid clusters with an axis, in their order (ours).

    graph   : of the reference mesh
    cluster : (node,) see `rigid_clusters`
    returns : one value for each limb
    """
    settings = settings or RollCandidatesSettings()
    owner = graph.bound[graph.sample, graph.weight[graph.sample].argmax(axis=1)]
    out = []
    for number in range(int(cluster.max(initial=-1)) + 1):
        node, sample = np.flatnonzero(cluster == number), graph.sample[cluster[owner] == number]
        if len(node) < settings.nodes or len(sample) < settings.samples:
            continue
        count = min(len(sample), settings.most_samples)
        sample = sample[np.arange(count) * len(sample) // count]
        middle = graph.V[sample].mean(axis=0)
        _, width, axes = np.linalg.svd(graph.V[sample] - middle, full_matrices=False)
        if width[0] >= settings.elongation * width[1]:
            out.append(Limb(node, sample, middle, axes[0]))
    return out


def roll_candidates(
    graph: DeformationGraph, pose: Pose, target: Target, cluster: Ints, settings: RollCandidatesSettings | None = None
) -> RollCandidates:
    """Every limb fitted as a rigid body from each of the starts around its axis (ours).

    graph   : of the reference mesh
    pose    : of this frame, from an earlier pass
    target  : the frame
    cluster : (node,) see `rigid_clusters`
    returns : RollCandidates; the first candidate starts where the limb is
    """
    settings = settings or RollCandidatesSettings()
    every = limbs(graph, cluster, settings)
    shape = (len(every), settings.starts)
    out = RollCandidates(np.zeros(shape), np.ones(shape), np.zeros((*shape, 3, 3)), np.zeros((*shape, 3)))
    size = target.size
    limits = (
        settings.beta * size,
        settings.reach * size,
        settings.scale * size,
        settings.misfit_scale * size,
        settings.cosine,
        settings.damping,
    )
    surface = target.V, target.N, target.start, target.ring
    for k, limb in enumerate(every):
        V, N = graph.V[limb.sample] - limb.middle, graph.N[limb.sample]
        R, c = rigid_motion(graph.g[limb.node] - limb.middle, pose.translation[limb.node])
        match = target.nearest(V @ R.T + c, N @ R.T)
        for h in range(settings.starts):
            begun = R @ Rotation.from_rotvec(2.0 * np.pi * h / settings.starts * limb.axis).as_matrix()
            out.rotation[k, h], out.place[k, h], out.misfit[k, h] = _iterated(
                V, N, begun, c, match, *surface, *limits, settings.steps
            )
        out.angle[k] = _roll_angle(limb.axis, R.T @ out.rotation[k])
    return out


def rolled(graph: DeformationGraph, pose: Pose, cluster: Ints, candidates: RollCandidates, chosen: Ints) -> Pose:
    """The pose with some limbs in another roll (ours).

    graph      : of the reference mesh
    pose       : of the frame, as it was given to `roll_candidates` with `cluster`
    cluster    : (node,) see `rigid_clusters`
    candidates : of this frame
    chosen     : (limb,) the candidate each takes, −1 where it stays
    returns    : Pose, in which the nodes of a limb that rolled move as one; the others are as they were
    """
    R, p = pose.rotation.copy(), pose.translation.copy()
    for k, limb in enumerate(limbs(graph, cluster)):
        if chosen[k] >= 0:
            turned = candidates.rotation[k, chosen[k]]
            R[limb.node] = turned
            p[limb.node] = (graph.g[limb.node] - limb.middle) @ turned.T + candidates.place[k, chosen[k]]
    return Pose(R, p)


def _roll_angle(axis: Floats, R: Floats) -> Floats:
    """(candidate,) roll of each rotation (candidate, 3, 3) about an axis, radians: Procrustes in the plane across it."""
    a, b = np.linalg.svd(axis[None])[2][1:]
    sign = np.sign(np.cross(a, b) @ axis)
    sine, cosine = (b @ R @ a - a @ R @ b), (a @ R @ a + b @ R @ b)
    return np.asarray(sign * np.arctan2(sine, cosine))


@compiled
def _iterated(
    P: Floats, N: Floats, R: Floats, c: Floats, match: Ints, V: Floats, M: Floats, start: Ints, ring: Ints,
    beta: float, reach: float, scale: float, misfit_scale: float, cosine: float, damping: float, steps: int,
) -> tuple[Floats, Floats, float]:  # fmt: skip
    """Gauss–Newton of Σ w (m·(R v + c − y))², w = (n·m) / (1 + (off / scale)²)²; R, c and the misfit."""
    turn, place = R.copy().reshape(1, 3, 3), c.copy().reshape(1, 3)
    misfit = 1.0
    for i in range(steps + 1):
        x, n = _placed(P, turn[0], place[0]), _placed(N, turn[0], np.zeros(3))
        match = local_matches(x, n, match, V, M, start, ring, beta)
        A, b, misfit = _normal_equations(x, n, place[0], V[match], M[match], reach, scale, misfit_scale, cosine)
        if i < steps:
            for block in range(2):
                mean = 0.0
                for k in range(3):
                    mean += A[3 * block + k, 3 * block + k]
                for k in range(3):
                    A[3 * block + k, 3 * block + k] += damping / 3.0 * mean + 1e-30
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
    x: Floats, n: Floats, c: Floats, y: Floats, m: Floats, reach: float, scale: float, misfit_scale: float, cosine: float
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
        if not (alike > cosine and square < reach * reach):
            misfit += 1.0
            continue
        for k in range(3):
            half[k] /= np.sqrt(length)
            off += (x[i, k] - y[i, k]) * half[k]
        misfit += 1.0 - alike / (1.0 + (off / misfit_scale) ** 2)
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
