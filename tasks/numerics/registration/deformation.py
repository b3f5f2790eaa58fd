"""The reference mesh bent onto one frame by turning and shifting the nodes of its graph: Gauss–Newton (for 2014, §5.3).

x(v) = Σ_j w_vj [R_j (v − g_j) + p_j]  (Sumner 2007, Eq. 1). The energy is Σ a [(n·(x − y))² + b |x − y|²] over matches
both ways, plus λ Σ s_jk |R_j (g_k − g_j) + p_j − p_k|² over both ends of every edge. The data count one per node in all, so
that λ does not depend on how many samples or nodes there are.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.registration.block_system import add_data, add_forms, block_inverses, conjugate_gradients
from kinetree.tasks.numerics.registration.colour_term import Compared
from kinetree.tasks.numerics.registration.coloured_matches import agreeing_colours, coloured_matches, forms_of_matches
from kinetree.tasks.numerics.registration.correspondence import CorrespondenceSettings, Target, local_matches
from kinetree.tasks.numerics.registration.deformation_graph import DeformationGraph
from kinetree.tasks.numerics.registration.edges import add_edges, edge_energy
from kinetree.tasks.numerics.registration.graph_kinematics import deformed, stepped, turned
from kinetree.tasks.numerics.registration.match_rows import MatchRows, match_rows, residuals, row_energies

_Pair = tuple[Ints, Ints]
"""Of the body and of the frame."""

_DAMPING = 1e-4
"""Added to the diagonal, share of its mean."""
_TOLERANCE = 1e-2
"""Of conjugate gradients: the next step has other matches anyway."""
_HALVINGS = 3
"""Times a step that raises the energy is halved before it is left out."""


@dataclass(frozen=True)
class FitSettings:
    """How one frame is fitted; of a pair, the first step takes the first value, the last the second, between geometric.

    Chosen on: not recorded. Halved or doubled, each moves some joint in some frame of a generated tree of 1,200 vertices by
    8 % of its height or more. Half of `steps`, half of `reach` or twice `stiffness` double the tree's mean error, twice
    `point_weight` raises it by two thirds; on a human half of `stiffness` raises it by a fifth.

    steps        : Gauss–Newton steps
    stiffness    : λ
    reach        : matches farther apart do not count, share of √area
    scale        : distance from the plane at which a match counts a quarter, share of √area
    point_weight : b, what distance counts beside distance from the plane
    solver_steps : conjugate-gradient steps in each Gauss–Newton step, at most
    searches     : so many steps search for matches among all samples, later ones start from the last matches
    thin         : of the samples of both surfaces every so many are used
    beta         : what a turn of the normal by one radian counts against distance in local searches, share of √area
    """

    steps: int
    stiffness: tuple[float, float]
    reach: tuple[float, float]
    scale: tuple[float, float]
    point_weight: tuple[float, float]
    solver_steps: int
    searches: int = 3
    thin: int = 2
    beta: float = CorrespondenceSettings().beta


class Pose(NamedTuple):
    """What the nodes do in one frame.

    rotation    : (node, 3, 3) R
    translation : (node, xyz) p, where each node is, mesh unit
    """

    rotation: Floats
    translation: Floats


class Fitted(NamedTuple):
    """A frame's fit.

    pose   : Pose
    energy : (step, 2) before and after each step with its matches, in the body's size²
    """

    pose: Pose
    energy: Floats


class _Forms(NamedTuple):
    """What colours add to every match: rᵀHr − 2 rᵀp + c with r = x − y."""

    H: Floats
    p: Floats
    c: Floats


class _Rows(NamedTuple):
    """Matches of one step: those that count, the frame's points, the weight of distance, and colours where they count."""

    match: MatchRows
    V: Floats
    nearness: Floats
    colour: _Forms | None = None


class _System(NamedTuple):
    """Room for the normal equations of a step: new memory costs more than its filling; arrays as in `add_data`."""

    D: Floats
    B: Floats
    b: Floats


class _Posed(NamedTuple):
    """The body in a pose, every vertex: (vertex, xyz)."""

    pose: Pose
    x: Floats


def at_rest(graph: DeformationGraph) -> Pose:
    """The pose in which the body is its reference: no node turned, each at its rest position."""
    return Pose(np.tile(np.eye(3), (len(graph.node), 1, 1)), graph.g)


def shape(graph: DeformationGraph, pose: Pose) -> tuple[Floats, Floats]:
    """The body in a pose (Sumner 2007, Eq. 1).

    returns : (vertex, xyz) mesh unit · (vertex, xyz) unit normals
    """
    x = deformed(graph.V, graph.bound, graph.weight, graph.g, *pose)
    return x, turned(graph.N, graph.bound, graph.weight, pose.rotation)


def bending(graph: DeformationGraph, pose: Pose) -> float:
    """How far the graph bends, every edge alike, mesh unit²."""
    return float(edge_energy(graph.edge, np.ones(len(graph.edge)), *pose, graph.g))


def fit(
    graph: DeformationGraph,
    start: Pose,
    target: Target,
    settings: FitSettings,
    stiffness: Floats | None = None,
) -> Fitted:
    """Bend the reference onto a frame by Gauss–Newton steps (ours, for 2014, Sec. 5.3).

    graph     : of the reference mesh
    start     : the pose to begin with, of a frame nearby or of this frame from an earlier pass
    target    : the frame
    settings  : how it is fitted
    stiffness : (edge,) s, 1 everywhere if not given
    returns   : Fitted; a step that would raise the energy is halved, and left out if that does not help
    """
    s = np.ones(len(graph.edge)) if stiffness is None else stiffness
    body, energy, match, shown = _posed(graph, start), np.zeros((settings.steps, 2)), None, None
    samples = graph.sample[:: settings.thin], target.sample[:: settings.thin]
    nodes = len(graph.node)
    room = _System(np.empty((nodes, 6, 6)), np.empty((len(graph.pair), 6, 6)), np.empty((nodes, 6)))
    for i in range(settings.steps):
        share = i / max(settings.steps - 1, 1)
        lam, reach, scale, b = (
            first * (last / first) ** share
            for first, last in (settings.stiffness, settings.reach, settings.scale, settings.point_weight)
        )
        x, n = body.x, turned(graph.N, graph.bound, graph.weight, body.pose.rotation)
        if shown is None:
            last = None if i < settings.searches else match
            match = _matches(graph, target, samples, x, n, last, settings.beta * target.size)
        if shown is not None or i + 1 == settings.searches:
            begun = None if shown is None else match
            shown = agreeing_colours(graph, target, samples, match)
            if shown is not None:
                match = coloured_matches(graph, target, samples, x, n, begun, shown, settings.beta * target.size)
        rows = _rows(graph, target, samples, x, n, match, (reach * graph.size, scale * graph.size, b), shown)
        body, energy[i] = _step(graph, body, rows, room, lam * s, settings.solver_steps)
    return Fitted(body.pose, energy / graph.size**2)


def _posed(graph: DeformationGraph, pose: Pose) -> _Posed:
    return _Posed(pose, deformed(graph.V, graph.bound, graph.weight, graph.g, *pose))


def _matches(
    graph: DeformationGraph, target: Target, samples: _Pair, x: Floats, n: Floats, last: _Pair | None, beta: float
) -> _Pair:
    """(sample,) the frame's vertex for each of the body's samples · (sample,) the body's vertex for each of the frame's.

    x, n : the body now · last : matches to start from, or None to search · beta : β of the local search, mesh unit
    """
    body_sample, frame_sample = samples
    y, m = target.V[frame_sample], target.N[frame_sample]
    if last is None:
        tree = cKDTree(np.hstack([x[body_sample], target.beta * n[body_sample]]), balanced_tree=False)
        last = target.nearest(x[body_sample], n[body_sample]), body_sample[tree.query(np.hstack([y, target.beta * m]))[1]]
    there = local_matches(x[body_sample], n[body_sample], last[0], target.V, target.N, target.start, target.ring, beta)
    return there, local_matches(y, m, last[1], x, n, graph.start, graph.ring, beta)


def _rows(
    graph: DeformationGraph,
    target: Target,
    samples: _Pair,
    x: Floats,
    n: Floats,
    match: _Pair,
    limits: tuple[float, float, float],
    shown: Compared | None,
) -> _Rows:
    """Matches nearer than `reach`, weighted (see `match_rows`); limits: reach, scale, b."""
    reach, scale, b = limits
    vertex, other = np.concatenate([samples[0], match[1]]), np.concatenate([match[0], samples[1]])
    share = len(graph.node) / len(vertex)
    rows = MatchRows(*match_rows(x, n, target.V, target.N, vertex, other, reach, scale, share))
    forms = None
    if shown is not None:
        forms = _Forms(*forms_of_matches(target, shown, rows.vertex, rows.other, rows.residual, rows.plane))
    return _Rows(rows, target.V, b * rows.plane, forms)


def _energy(graph: DeformationGraph, pose: Pose, r: Floats, rows: _Rows, stiffness: Floats) -> float:
    """The energy with these matches, mesh unit²; r : (row, xyz) x − y."""
    plane, distance = row_energies(r, rows.match.normal, rows.match.plane, rows.nearness)
    data = plane.sum() + distance.sum()
    if rows.colour is not None:
        H, p, c = rows.colour
        data += (np.einsum("rx,rxy,ry->r", r, H, r) - 2.0 * np.einsum("rx,rx->r", r, p) + c).sum()
    return float(data) + edge_energy(graph.edge, stiffness, *pose, graph.g)


def _whole_forms(rows: _Rows, colour: _Forms, r: Floats) -> tuple[Floats, Floats]:
    """(row, 3, 3) form and (row, xyz) slope at r of plane, point and colour together."""
    H, p, _ = colour
    n, plane = rows.match.normal, rows.match.plane[:, None]
    M = H + plane[:, :, None] * n[:, :, None] * n[:, None, :] + rows.nearness[:, None, None] * np.eye(3)
    return M, np.einsum("rxy,ry->rx", M, r) - p


def _step(
    graph: DeformationGraph, body: _Posed, rows: _Rows, room: _System, stiffness: Floats, solves: int
) -> tuple[_Posed, tuple[float, float]]:
    """One Gauss–Newton step with fixed matches, and the energy before and after."""
    vertex, other, r, normal, plane = rows.match
    before = _energy(graph, body.pose, r, rows, stiffness)
    g, R = graph.g, body.pose.rotation
    D, B, b = room
    for array in room:
        array.fill(0.0)
    rest = (graph.V, graph.bound, graph.weight, graph.of_vertex)
    if rows.colour is None:
        add_data(D, B, b, *rest, R, g, vertex, r, normal, plane, rows.nearness)
    else:
        add_forms(D, B, b, *rest, R, g, vertex, *_whole_forms(rows, rows.colour, r))
    add_edges(D, B, b, graph.edge, graph.of_edge, stiffness, *body.pose, g)
    D[:, range(6), range(6)] += _DAMPING * np.einsum("jaa->ja", D).mean(axis=0)
    step = conjugate_gradients(D, block_inverses(D), B, graph.pair, b, solves, _TOLERANCE)
    for halving in range(_HALVINGS):
        moved = _posed(graph, Pose(*stepped(*body.pose, step, 0.5**halving)))
        after = _energy(graph, moved.pose, residuals(moved.x, vertex, rows.V, other), rows, stiffness)
        if after <= before:
            return moved, (before, after)
    return body, (before, before)
