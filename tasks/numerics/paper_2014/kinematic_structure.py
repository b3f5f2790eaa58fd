"""The finished articulated body of the 2014 paper: rotations, fixed lengths, bones to the leaves, names (Sec. 6.3)."""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.paper_2014.fixed_lengths import Observed, Posed, posed, rotations
from kinetree.tasks.numerics.paper_2014.joint_tree import JointTree
from kinetree.tasks.numerics.structure.joint_names import joint_names
from kinetree.tasks.numerics.structure.joint_rotations import turning_range
from kinetree.tasks.numerics.structure.kinematic_tree import KinematicTree


class KinematicStructureSettings(NamedTuple):
    """How confident a joint's position is (ours)."""

    half_confidence: float = 0.04
    """Distance between a joint and the centroid of its area at which confidence is one half, share of the root of the area.
    Not recorded what it was chosen on; it changes the reported confidence only."""


class Model(NamedTuple):
    """The model mesh with its areas.

    V     : (vertex, xyz) mesh unit
    area  : (vertex,) mesh unit²
    label : (vertex,) area, rigid or not
    part  : (area,) rigid part of each area, −1 for joints
    """

    V: Floats
    area: Floats
    label: Ints
    part: Ints


def kinematic_structure(
    model: Model,
    x: Floats,
    tree: JointTree,
    centroid: Floats,
    leaf_vertex: Ints,
    leaf_position: Floats,
    surface: float = 1.0,
    settings: KinematicStructureSettings | None = None,
) -> KinematicTree:
    """Rotations of the parts, fixed bone lengths, bones to the leaves, skin and names of all joints (Sec. 6.3.2).

    model         : the mesh that the skeleton is of
    x             : (frame, vertex, xyz) its vertices in every frame, mesh unit, NaN where not seen
    tree          : joints and parts
    centroid      : (frame, area, xyz) mesh unit, NaN where not seen
    leaf_vertex   : (leaf,) vertex of the model mesh at each leaf
    leaf_position : (frame, leaf, xyz) mesh unit, NaN where not seen
    surface       : weight of a part's surface against one joint
    """
    settings = settings or KinematicStructureSettings()
    carried = _carried(model, tree)
    node = _nodes(carried)
    R = np.stack([rotations(model.V, x, own) for own in carried], axis=1)
    weight = model.area * carried[0]
    X = np.concatenate([np.full((len(x), 1, 3), np.nan), centroid[:, tree.joint[1:]]], axis=1)
    X[:, 0] = _visible_middle(weight, x)
    leaf_node = _leaf_nodes(node, model.label, tree, leaf_vertex)
    root = weight @ model.V / weight.sum()
    observed = Observed(X, R, leaf_position)
    motion = posed(model.V, x, node, tree.parents, observed, root, leaf_node, surface)
    half = settings.half_confidence * float(np.sqrt(model.area.sum()))
    return _assembled(model, node, tree, observed, leaf_node, motion, half)


def _carried(model: Model, tree: JointTree) -> list[Flags]:
    """Of each node, (vertex,) its part's vertices, else its joint's own area; all vertices if there are none of either."""
    part = model.part[model.label] if len(model.part) else np.zeros_like(model.label)
    own = [part == p if p >= 0 else model.label == j for j, p in zip(tree.joint, tree.part, strict=True)]
    return [vertices if vertices.any() else np.ones(len(model.label), dtype=bool) for vertices in own]


def _nodes(carried: list[Flags]) -> Ints:
    """(vertex,) the node that carries a vertex, −1 for a joint beyond which there is a part."""
    node = np.full(len(carried[0]), -1)
    for n, own in enumerate(carried):
        node[own & (node < 0)] = n
    return node


def _visible_middle(weight: Floats, x: Floats) -> Floats:
    """(frame, xyz) weighted middle of the vertices that are seen; NaN where none is."""
    visible_weight = weight * np.isfinite(x[:, :, 0])
    total = visible_weight.sum(axis=1)[:, None]
    middle = np.einsum("tv,tvx->tx", visible_weight, np.nan_to_num(x))
    return np.asarray(np.where(total > 0.0, middle / np.maximum(total, 1e-300), np.nan), dtype=np.float64)


def _leaf_nodes(node: Ints, label: Ints, tree: JointTree, leaf_vertex: Ints) -> Ints:
    """(leaf,) the node on which each leaf's bone hangs: the one that carries it, else that of the joint it lies in."""
    out = node[leaf_vertex].copy()
    for e in np.flatnonzero(out < 0):
        own = np.flatnonzero(tree.joint == label[leaf_vertex[e]])
        out[e] = own[0] if len(own) else 0
    return out


def _assembled(
    model: Model, node: Ints, tree: JointTree, observed: Observed, leaf_node: Ints, posed: Posed, half: float
) -> KinematicTree:
    """Nodes and leaves as one list of joints, named and in the order of their names.

    A joint's confidence is 1 / (1 + (distance / half)²) of its distance to where it was observed, and 0 where it was not.
    """
    nodes, frames = len(tree.parents), len(observed.joint)
    carrying = np.concatenate([np.arange(nodes), leaf_node])
    above = np.concatenate([tree.parents, leaf_node])
    rest = np.concatenate([posed.motion.rest, posed.leaf_rest])
    is_leaf = np.arange(len(above)) >= nodes
    order, names = joint_names(rest, above, is_leaf)
    position = np.argsort(order)
    R = posed.motion.R
    turns = np.einsum("tpxy,tpxz->tpyz", R[:, np.maximum(tree.parents, 0)], R)
    degrees = np.array([0.0, *(turning_range(turns[:, p]) for p in range(1, nodes)), *np.zeros(len(leaf_node))])
    observed_in = np.isfinite(np.concatenate([observed.joint, observed.leaf], axis=1)[:, :, 0])
    leaf_distance = np.linalg.norm(posed.leaf_positions - observed.leaf, axis=2)
    distance = np.nan_to_num(np.concatenate([posed.distance, leaf_distance], axis=1))
    influence, weight = _skin(model.label, node, tree)
    rigid = model.part[model.label] >= 0 if len(model.part) else np.ones(len(model.V), dtype=bool)
    return KinematicTree(
        names=names,
        kinds=tuple("leaf" if is_leaf[j] else "joint" if above[j] >= 0 else "root" for j in order),
        parents=np.where(above[order] >= 0, position[above[order]], -1),
        rest=rest[order],
        positions=np.concatenate([posed.positions, posed.leaf_positions], axis=1)[:, order],
        rotation=R[:, carrying[order]],
        confidence=(observed_in / (1.0 + (distance / half) ** 2))[:, order].reshape(frames, -1),
        degrees=degrees[order],
        drift=np.concatenate([posed.drift, np.zeros(len(leaf_node))])[order],
        support=observed_in.sum(axis=0)[order],
        label=np.where(rigid & (node >= 0), position[node], -1),
        influence=np.where(weight > 0, position[influence], 0),
        weight=weight,
    )


def _skin(label: Ints, node: Ints, tree: JointTree) -> tuple[Ints, Floats]:
    """(vertex, 4) nodes and weights: vertices with a node follow it, a joint's area the parts it joins in equal shares."""
    influence, weight = np.zeros((len(label), 4), np.int64), np.zeros((len(label), 4))
    influence[:, 0], weight[:, 0] = np.maximum(node, 0), 1.0
    for joint in np.unique(label[node < 0]):
        nodes = np.flatnonzero(tree.joint == joint)
        joined = np.unique([*tree.parents[nodes], *nodes])[:4]
        own = (label == joint) & (node < 0)
        if len(joined):
            influence[own, : len(joined)], weight[own, : len(joined)] = joined, 1.0 / len(joined)
    return influence, weight
