"""An initial model brought to another frame: drawn by forces, then laid on the surface (2009, Sec. 2.3.1, 3.2).

The paper shifts nodes by forces alone, and names as its next step a volumetric fit with a model of bones and skin. Here the
forces give that fit its start: the model's surface follows its nodes and is fitted to the frame's with bones of fixed length.
"""

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.edge_rings import averaged_normals, edge_rings
from kinetree.tasks.numerics.paper_2009.graph_deformation import Forces, along_branches, deformed_graph, least_turns
from kinetree.tasks.numerics.registration.correspondence import Target, local_matches
from kinetree.tasks.numerics.registration.graph_kinematics import deformed
from kinetree.tasks.numerics.registration.vertex_confidence import VertexConfidence, vertex_confidence
from kinetree.tasks.numerics.structure.articulated_frame import FramePose, SkinnedBody, joints, surface
from kinetree.tasks.numerics.structure.surface_fit import SurfaceFitSettings, fitted_to_surface
from kinetree.tasks.numerics.structure.surface_matches import Matches, uncovered

UNCOVERED = 0.08
"""Share of a frame's surface that a fit may leave uncovered before another start is tried. Chosen on carved humans, where good
fits leave 0.01 to 0.07."""


class Model(NamedTuple):
    """The tree of nodes, see `graph_body.GraphBody`, and the root of its surface's area."""

    node: Floats
    parents: Ints
    joint: Floats
    branch: Ints
    end: Ints
    size: float


class TargetGraph(NamedTuple):
    """The graph of the frame.

    node  : (node, xyz) mesh unit
    leaf  : (branch,) leaf of the model that each branch ends in, −1 for none
    lines : of each branch its nodes from the end inwards (point, xyz)
    """

    node: Floats
    leaf: Ints
    lines: list[Floats]


class ModelPose(NamedTuple):
    """Where the model is.

    position : (node, xyz) mesh unit · rotation : (node, 3, 3) from the initial frame
    drifted  : mean distance of its nodes, after the forces, from the nearest nodes of the target, mesh unit
    """

    position: Floats
    rotation: Floats
    drifted: float


def at_rest(model: Model) -> ModelPose:
    """The model in its initial frame."""
    return ModelPose(model.node.copy(), np.repeat(np.eye(3)[None], len(model.node), axis=0), 0.0)


def drawn(model: Model, last: ModelPose, target: TargetGraph, forces: Forces, *, branches: bool) -> ModelPose:
    """The model drawn to a graph by forces, from where it was.

    branches : whether a limb's nodes drift to the point of the same limb that is as far from its leaf
    """
    pulled, towards = None, None
    if branches:
        pulled, towards = along_branches(model.node, model.parents, model.branch, model.end, target.leaf, target.lines)
    x = deformed_graph(model.node, model.parents, last.position, target.node, model.size, forces, pulled, towards)
    R = least_turns(model.node, model.parents, last.rotation, x)
    away = np.linalg.norm(x[:, None] - target.node[None], axis=2).min(axis=1) if len(target.node) else np.zeros(1)
    return ModelPose(x, R, float(away.mean()))


def laid_on(model: Model, body: SkinnedBody, pose: ModelPose, frame: Target, hold: float) -> ModelPose:
    """The model's surface fitted to the frame's, nodes held in the turns that they have at rest.

    hold : weight of a node's turn against its parent, against its piece of surface seen in full
    """
    straight = np.repeat(np.eye(3)[None], len(pose.rotation), axis=0)
    straight[0] = pose.rotation[0]
    start = FramePose(pose.rotation, pose.position[0])
    nothing = np.zeros(len(body.V))
    fit = fitted_to_surface(body, start, frame, body.V, nothing, straight, SurfaceFitSettings(hold=hold))
    X = joints(body, fit)
    return ModelPose(X + np.einsum("nxy,ny->nx", fit.R, model.node - model.joint), fit.R, pose.drifted)


def best_laid(model: Model, body: SkinnedBody, starts: list[ModelPose], frame: Target, hold: float) -> ModelPose:
    """Of the fits from several starts the one that leaves the least of the frame's surface uncovered.

    A start is tried only where the fits before it leave more than `UNCOVERED`.
    """
    best, least = starts[0], np.inf
    for start in starts:
        fit = laid_on(model, body, start, frame, hold)
        pose = FramePose(fit.rotation, fit.position[0])
        uncovered = uncovered_share(body, pose, frame)
        if uncovered < least:
            best, least = fit, uncovered
        if least <= UNCOVERED:
            break
    return best


def uncovered_share(body: SkinnedBody, pose: FramePose, frame: Target) -> float:
    """Share of a frame's samples that a pose of the body leaves uncovered, 0 to 1.

    Only the frame's samples are matched with the body: the other way takes most of `surface_matches.searched`.
    """
    x, n = surface(body, pose)
    V, N, s = frame.V[frame.sample], frame.N[frame.sample], body.sample
    tree = cKDTree(np.hstack([x[s], frame.beta * n[s]]), balanced_tree=False)
    nearest = s[tree.query(np.hstack([V, frame.beta * N]))[1]]
    backward = local_matches(V, N, nearest, x, n, body.start, body.ring, frame.beta)
    none = np.zeros(0, np.int64)
    return float(uncovered(body, frame, Matches(x, n, none, none > 0, backward)).mean())


def model_quality(body: SkinnedBody, x: Floats, frame: Target) -> VertexConfidence:
    """How well the model's surface x (vertex, xyz) lies on a frame; that much is uncovered does not lower its confidence."""
    n = averaged_normals(x, body.F, *edge_rings(body.F, len(x)))
    return vertex_confidence(body.V, x, n, body.F, frame, usual=1.0)


def posed_surface(model: Model, body: SkinnedBody, pose: ModelPose) -> Floats:
    """(vertex, xyz) the model's surface as its nodes carry it, mesh unit."""
    R = np.ascontiguousarray(pose.rotation)
    X = pose.position + np.einsum("nxy,ny->nx", R, model.joint - model.node)
    return deformed(body.V, body.bound, body.weight, body.rest, R, np.ascontiguousarray(X))


def branch_lines(node: Floats, edge: npt.NDArray[np.integer[Any]], branch: Ints, end: Ints) -> list[Floats]:
    """Of each branch its nodes from the end inwards, (point, xyz)."""
    near: list[list[int]] = [[] for _ in node]
    for a, b in edge.tolist():
        near[a].append(b)
        near[b].append(a)
    lines = []
    for leaf, n in enumerate(end.tolist()):
        way, before = [n], -1
        while True:
            onward = [m for m in near[way[-1]] if m != before and branch[m] == leaf]
            if len(onward) != 1 or branch[way[-1]] != leaf:
                break
            before = way[-1]
            way.append(onward[0])
        lines.append(node[way])
    return lines
