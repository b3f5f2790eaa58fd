"""A pose whose limbs are swung to where the topology of a frame shows limbs: a start where no fit reaches them (ours).

Matches reach a limb that moved less than the distance to the next one. Stems, from the root of a limb to its tip, are known in
every frame by its own surface, however fast it moves. A point inside the body follows the nodes around it, as vertices do; so
nodes are moved until such points lie on the stems, and bend as little as they can (Sorkine and Alexa 2007, on the graph).
"""

from typing import NamedTuple

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.optimize import linear_sum_assignment
from scipy.sparse import csr_array
from scipy.spatial import cKDTree

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.rigid_fit import nearest_rotation
from kinetree.tasks.numerics.registration.deformation import Pose, shape
from kinetree.tasks.numerics.registration.deformation_graph import DeformationGraph


class LimbSwingSettings(NamedTuple):
    """How limbs are swung. Not varied, but for `rounds`."""

    near: int = 6
    """Nodes that carry a point of a stem."""
    weight: float = 1.0
    """What the distances of all points from the stems weigh, against one edge for every node."""
    rounds: int = 10
    """Rounds in which nodes are moved and then turned. With 5, 20 and 40 as many limbs of a dance and a wolf come back."""
    held: float = 1e-3
    """Share of its former rotation in a node's new one, so that a node without edges has one."""
    anchor: float = 1e-6
    """Weight of a node's place against that of one edge: too little to be seen but in a piece that lies apart and has no limb,
    which goes along with the body as a whole."""


class StemPoints(NamedTuple):
    """Points along the limbs of the body at rest, and the nodes that carry them.

    rest   : (point, xyz) mesh unit
    node   : (point, near)
    weight : (point, near) each row sums to 1
    """

    rest: Floats
    node: Ints
    weight: Floats


class FrameLimbs(NamedTuple):
    """The limbs of the body at rest, and those that a frame shows.

    rest   : (limb, station, xyz) stems of the reference, see `extrema.stems`, mesh unit
    frame  : (limb, station, xyz) of the frame
    centre : (xyz) of the frame's surface, mesh unit
    """

    rest: Floats
    frame: Floats
    centre: Floats


def swung(
    graph: DeformationGraph,
    pose: Pose,
    stems: Floats,
    seen: Floats,
    centre: Floats,
    settings: LimbSwingSettings | None = None,
) -> Pose | None:
    """The pose with every limb swung to the stem of a frame that lies nearest about the body's centre, each to one (ours).

    graph   : of the reference mesh
    pose    : to begin with, of a frame nearby
    stems   : (limb, station, xyz) of the reference, see `extrema.stems`, mesh unit
    seen    : (limb, station, xyz) of the frame
    centre  : (xyz) of the frame's surface, mesh unit
    returns : Pose; None where one of both has no limbs
    """
    chosen = settings or LimbSwingSettings()
    if not len(stems) or not len(seen):
        return None
    points = stem_points(graph, stems, chosen)
    now = carried(graph, pose, points).reshape(stems.shape) - shape(graph, pose)[0][graph.sample].mean(axis=0)
    limb, other = linear_sum_assignment(np.linalg.norm(now[:, None] - (seen - centre)[None], axis=3).mean(axis=2))
    row = (limb[:, None] * stems.shape[1] + np.arange(stems.shape[1])).ravel()
    return _reached(graph, pose, StemPoints(*(array[row] for array in points)), seen[other].reshape(-1, 3), chosen)


def stem_points(graph: DeformationGraph, stems: Floats, settings: LimbSwingSettings | None = None) -> StemPoints:
    """Points of stems with the nodes around them, which carry them the more the nearer they are.

    stems : (limb, station, xyz) of the reference, mesh unit
    """
    near = min((settings or LimbSwingSettings()).near, len(graph.node) - 1)
    rest = stems.reshape(-1, 3)
    distance, node = cKDTree(graph.g).query(rest, k=range(1, near + 2))
    weight = (1.0 - distance[:, :-1] / distance[:, -1:]) ** 2 + np.finfo(float).eps
    return StemPoints(rest, node[:, :-1].astype(np.int64), weight / weight.sum(axis=1, keepdims=True))


def carried(graph: DeformationGraph, pose: Pose, points: StemPoints) -> Floats:
    """Where nodes carry points: (point, xyz) mesh unit, x = Σ_j w_j [R_j (c − g_j) + p_j]."""
    return _turned(graph, pose.rotation, points) + np.einsum("mk,mkx->mx", points.weight, pose.translation[points.node])


def _turned(graph: DeformationGraph, R: Floats, points: StemPoints) -> Floats:
    """(point, xyz) Σ_j w_j R_j (c − g_j)."""
    away = points.rest[:, None] - graph.g[points.node]
    return np.einsum("mk,mkxy,mky->mx", points.weight, R[points.node], away)


def _reached(graph: DeformationGraph, pose: Pose, points: StemPoints, goal: Floats, settings: LimbSwingSettings) -> Pose:
    """The pose of least Σ |R_j (g_k − g_j) + p_j − p_k|² + weight · |points − goal|², by moving and turning nodes in turn."""
    nodes, edges = len(graph.node), np.arange(len(graph.edge))
    a, b = graph.edge.T
    e = graph.g[b] - graph.g[a]
    signs, ends = np.repeat([-1.0, 1.0], len(e)), np.concatenate([a, b])
    difference = csr_array((signs, (np.tile(edges, 2), ends)), shape=(len(e), nodes))
    M = np.zeros((len(goal), nodes))
    np.put_along_axis(M, points.node, points.weight, axis=1)
    weight = settings.weight * nodes / len(goal)
    solver = cho_factor((2.0 * difference.T @ difference).toarray() + weight * M.T @ M + settings.anchor * np.eye(nodes))
    R, p = np.array(pose.rotation), np.array(pose.translation)
    along = p + (goal - carried(graph, pose, points)).mean(axis=0)
    floor = settings.held * np.square(e).sum() / nodes
    for _ in range(settings.rounds):
        both = np.einsum("exy,ey->ex", R[a] + R[b], e)
        p = cho_solve(solver, difference.T @ both + weight * M.T @ (goal - _turned(graph, R, points)) + settings.anchor * along)
        outer = np.einsum("ex,ey->exy", difference @ p, e).reshape(-1, 9)
        R = nearest_rotation((abs(difference).T @ outer).reshape(-1, 3, 3) + floor * R)
    return Pose(R, p)
