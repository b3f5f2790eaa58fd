"""A pose whose limbs are swung to where the topology of a frame shows limbs: a start where no fit reaches them (ours).

Matches reach a limb that moved less than the distance to the next one. Stems, from the root of a limb to its tip, are known in
every frame by its own surface, however fast it moves. A point inside the body follows the nodes around it, as vertices do; so
nodes are moved until such points lie on the stems, and bend as little as they can (Sorkine and Alexa 2007, on the graph).
"""

from collections.abc import Sequence
from itertools import combinations
from typing import NamedTuple

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.optimize import linear_sum_assignment
from scipy.sparse import csr_array
from scipy.spatial import cKDTree

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.rigid_fit import nearest_rotations
from kinetree.tasks.numerics.registration.deformation import Pose, bending, shape
from kinetree.tasks.numerics.registration.deformation_graph import DeformationGraph


class LimbSwingSettings(NamedTuple):
    """How limbs are swung.

    Varied were `rounds`, `exchange` (0.75 and 1) and `begun`, on people and recorded bodies at a quarter of their frames.
    """

    near: int = 6
    """Nodes that carry a point of a stem."""
    weight: float = 1.0
    """What the distances of all points from the stems weigh, against one edge for every node."""
    rounds: int = 10
    """Rounds in which nodes are moved and then turned. With 5, 20 and 40 as many limbs of a dance and a wolf come back."""
    exchange: float = 0.875
    """Share of the energy that an exchange of two stems must fall below. Right exchanges of five people had 0.22 to 0.77, a
    wrong one of a ballet 0.98, all others more than 1."""
    likely: float = 2.0
    """How many times the energy of the first way an exchange of two stems may have, to be a way as well. After half a turn of
    the trunk both arms lie as near to each other's stems: of two people who throw, at 6 frames a second, the true way has 0.98
    and 1.46 times the energy of the first. Chosen on them; fits on the frame tell the ways apart (`clearly`)."""
    ways: int = 3
    """Ways at most, for time."""
    clearly: float = 0.8
    """How much the fit of another way may bend, share of what that of the first bends, to count before it. Chosen on these
    two: 0.47 and 0.39."""
    begun: float = 2.0
    """How many times the energy it may have after one round, to be gone on with: right exchanges had 0.9 to 1.7 times."""
    stages: tuple[tuple[int, float], ...] = ((2, 12.0), (10, 4.0), (40, 2.0))
    """Where limbs may have been exchanged already: after how many rounds an exchange may have at most how many times the
    energy of the limbs as they are, to be begun again with more rounds, or taken after the last. Right ones had 4.5 to 9.7
    times after 2 rounds (four frames of two runners, a made-up twist of 95 and one of 115°), 0.4 to 3.2 after 10, 0.1 to 1.4
    after 40. Wrong ones in nine frames of three runners had 2.3 and more after 40."""
    pairs: int = 3
    """Pairs of limbs that are exchanged there, for time: those most alike in length, since a longer limb is seen to be one."""
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


def swings(
    graph: DeformationGraph,
    pose: Pose,
    stems: Floats,
    seen: Floats,
    centre: Floats,
    settings: LimbSwingSettings | None = None,
) -> list[Pose]:
    """Poses with every limb swung to a stem of a frame, each to one: so that the body bends least, and as likely ones (ours).

    Begun with the stems nearest about the body's centre; two limbs exchange theirs for as long as the body then bends
    clearly less. A trunk that twists fast brings each arm nearer to the other one's stem. A stem that no limb begins with is
    not tried.

    graph   : of the reference mesh
    pose    : to begin with, of a frame nearby
    stems   : (limb, station, xyz) of the reference, see `extrema.stems`, mesh unit
    seen    : (limb, station, xyz) of the frame
    centre  : (xyz) of the frame's surface, mesh unit
    returns : the way that no exchange of two stems betters clearly, then those exchanges of it that are as likely, those of
              less energy first; none where body or frame has no limbs
    """
    chosen = settings or LimbSwingSettings()
    if not len(stems) or not len(seen):
        return []
    shift = centre - shape(graph, pose)[0][graph.sample].mean(axis=0)
    swing, _, given = _nearest_stems(graph, pose, stems, seen, shift, chosen)
    return _least_energy_exchanges(swing, seen, given)


def with_two_exchanged(
    graph: DeformationGraph,
    pose: Pose,
    stems: Floats,
    seen: Floats,
    settings: LimbSwingSettings | None = None,
) -> list[Pose]:
    """Poses with the stems of two limbs exchanged whose energy is little more than with the stems as they are (ours).

    Tried are the pairs of limbs most alike in length. From a pose whose limbs were exchanged few rounds say little, so the
    likelier an exchange is, the more rounds it has (`stages`). A limb that the frame does not show, and a stem that no limb
    has, is not exchanged.

    graph   : of the reference mesh
    pose    : of this frame, as it was fitted
    stems   : (limb, station, xyz) of the reference, see `extrema.stems`, mesh unit
    seen    : (limb, station, xyz) of the frame
    returns : those of less energy first, `ways` at most; none where body or frame has less than two limbs
    """
    chosen = settings or LimbSwingSettings()
    if min(len(stems), len(seen)) < 2:
        return []
    swing, limb, given = _nearest_stems(graph, pose, stems, seen, np.zeros(3), chosen)
    length = np.linalg.norm(np.diff(stems[limb], axis=1), axis=2).sum(axis=1)
    size = np.log(np.maximum(length, np.finfo(float).tiny))
    pairs = sorted(combinations(range(len(given)), 2), key=lambda pair: abs(size[pair[0]] - size[pair[1]]))
    orders = [given, *(_exchanged(given, *pair) for pair in pairs[: chosen.pairs])]
    goals = np.stack([seen[order].reshape(-1, 3) for order in orders])
    ends: list[tuple[Pose, float]] = []
    for rounds, ratio in chosen.stages:
        (_, energy), *ends = swing.reached(goals, rounds)
        likely = [k for k, (_, least) in enumerate(ends) if least <= ratio * energy]
        if not likely:
            return []
        goals, ends = goals[[0, *(k + 1 for k in likely)]], [ends[k] for k in likely]
    return [end for end, _ in sorted(ends, key=lambda one: one[1])[: chosen.ways]]


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


class _Swing(NamedTuple):
    """What brings points of the body to any places, factorised once.

    graph, pose : Pose to begin with
    points      : to be brought somewhere
    solver      : of the normal equations of the nodes' places
    D, M        : (edge, node) difference along edges · (point, node) place of the points
    weight      : of the points' distances against those of one edge
    """

    graph: DeformationGraph
    pose: Pose
    points: StemPoints
    settings: LimbSwingSettings
    solver: tuple[Floats, bool]
    D: csr_array
    M: Floats
    weight: float

    @classmethod
    def of(cls, graph: DeformationGraph, pose: Pose, points: StemPoints, settings: LimbSwingSettings) -> "_Swing":
        """From a pose."""
        nodes, edges = len(graph.node), np.arange(len(graph.edge))
        signs, ends = np.repeat([-1.0, 1.0], len(edges)), graph.edge.T.ravel()
        D = csr_array((signs, (np.tile(edges, 2), ends)), shape=(len(edges), nodes))
        M = np.zeros((len(points.rest), nodes))
        np.put_along_axis(M, points.node, points.weight, axis=1)
        weight = settings.weight * nodes / len(points.rest)
        solver = cho_factor((2.0 * D.T @ D).toarray() + weight * M.T @ M + settings.anchor * np.eye(nodes))
        return cls(graph, pose, points, settings, solver, D, M, weight)

    def reached(self, goal: Floats, rounds: int) -> list[tuple[Pose, float]]:
        """The poses of least Σ |R_j (g_k − g_j) + p_j − p_k|² + weight · |points − goal|², by moving and turning nodes in turn.

        goal    : (pose, point, xyz) where the points are to be in each pose, mesh unit
        returns : (pose,) Pose · that sum, mesh unit²
        """
        graph, anchor, points = self.graph, self.settings.anchor, self.points
        a, b = graph.edge.T
        e = graph.g[b] - graph.g[a]
        R = np.repeat(self.pose.rotation[None], len(goal), axis=0)
        p = np.repeat(self.pose.translation[None], len(goal), axis=0)
        along = p + (goal - carried(graph, self.pose, points)).mean(axis=1, keepdims=True)
        floor = self.settings.held * np.square(e).sum() / len(graph.node)
        for _ in range(rounds):
            both = np.einsum("sexy,ey->sex", R[:, a] + R[:, b], e)
            pull = self.weight * self.M.T @ (goal - np.stack([_turned(graph, turns, points) for turns in R]))
            p = self._placed(_applied(self.D.T, both) + pull + anchor * along)
            outer = np.einsum("sex,ey->sexy", _applied(self.D, p), e).reshape(len(goal), -1, 9)
            H = _applied(abs(self.D).T, outer).reshape(R.shape) + floor * R
            R = nearest_rotations(H.reshape(-1, 3, 3)).reshape(R.shape)
        return [(pose, self._energy(pose, place)) for pose, place in zip(map(Pose, R, p), goal, strict=True)]

    def _placed(self, pull: Floats) -> Floats:
        """(pose, node, xyz) the places of nodes, from what pulls them."""
        columns = pull.transpose(1, 0, 2).reshape(pull.shape[1], -1)
        placed: Floats = cho_solve(self.solver, columns, check_finite=False)
        return placed.reshape(len(columns), -1, 3).transpose(1, 0, 2)

    def _energy(self, pose: Pose, goal: Floats) -> float:
        """The sum that `reached` makes least; goal (point, xyz), mesh unit²."""
        a, b = self.graph.edge.T
        e, along = self.graph.g[b] - self.graph.g[a], self.D @ pose.translation
        bent = sum(float(np.square(np.einsum("exy,ey->ex", pose.rotation[end], e) - along).sum()) for end in (a, b))
        return bent + self.weight * float(np.square(carried(self.graph, pose, self.points) - goal).sum())


def _nearest_stems(
    graph: DeformationGraph, pose: Pose, stems: Floats, seen: Floats, shift: Floats, chosen: LimbSwingSettings
) -> tuple[_Swing, Ints, Ints]:
    """Gives each limb the stem that is nearest once the body is shifted.

    shift   : (xyz,) mesh unit
    returns : what brings these limbs to any stems · (given,) limbs that have a stem · (given,) number of its stem
    """
    points = stem_points(graph, stems, chosen)
    now = carried(graph, pose, points).reshape(stems.shape) + shift
    limb, stem = linear_sum_assignment(np.linalg.norm(now[:, None] - seen[None], axis=3).mean(axis=2))
    row = (limb[:, None] * stems.shape[1] + np.arange(stems.shape[1])).ravel()
    return _Swing.of(graph, pose, StemPoints(*(array[row] for array in points)), chosen), limb, stem


def _applied(A: csr_array, x: Floats) -> Floats:
    """(pose, row, any) A x for every x (pose, column, any)."""
    return np.stack([A @ one for one in x])


def _least_energy_exchanges(swing: _Swing, stems: Floats, given: Ints) -> list[Pose]:
    """The pose with stems as given (limb,) or with pairs exchanged, for as long as an exchange has clearly less energy, and
    the exchanges of a pair that are then as likely.
    """
    chosen = swing.settings

    def reached(orders: list[Ints], rounds: int) -> list[tuple[Pose, float]]:
        return swing.reached(np.stack([stems[order].reshape(-1, 3) for order in orders]), rounds) if orders else []

    best, energy = reached([given], chosen.rounds)[0]
    while True:
        orders = [given, *(_exchanged(given, *pair) for pair in combinations(range(len(given)), 2))]
        begun = [one for _, one in reached(orders, 1)]
        near = [order for order, one in zip(orders[1:], begun[1:], strict=True) if one <= chosen.begun * begun[0]]
        ends = [(*end, order) for end, order in zip(reached(near, chosen.rounds), near, strict=True)]
        pose, least, order = min(ends, key=lambda one: one[1], default=(best, energy, given))
        if not least < chosen.exchange * energy:
            likely = sorted((end for end in ends if end[1] <= chosen.likely * energy), key=lambda end: end[1])
            return [best, *(end for end, _, _ in likely[: chosen.ways - 1])]
        best, energy, given = pose, least, order


def clearly_less_bent(graph: DeformationGraph, poses: Sequence[Pose], settings: LimbSwingSettings | None = None) -> int:
    """Which of some poses counts: the first, unless another one bends clearly less, then that which bends least."""
    bent = [bending(graph, pose) for pose in poses]
    least = int(np.argmin(bent))
    return least if bent[least] <= (settings or LimbSwingSettings()).clearly * bent[0] else 0


def _exchanged(stem: Ints, one: int, two: int) -> Ints:
    """The stems of the limbs, those of two limbs exchanged."""
    exchanged = stem.copy()
    exchanged[[one, two]] = stem[[two, one]]
    return exchanged
