"""Joints amid the edges at which clusters meet, as the paper's figures show them (2009, Sec. 2.4)."""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.geometry.rigid_fit import nearest_rotation
from kinetree.tasks.numerics.structure.joint_names import joint_names
from kinetree.tasks.numerics.structure.joint_rotations import joint_degrees
from kinetree.tasks.numerics.structure.kinematic_tree import KinematicTree
from kinetree.tasks.numerics.structure.skinning import few, heaviest


class EdgeJointsSettings(NamedTuple):
    """How confident a joint's position is (ours)."""

    half_confidence: float = 0.04
    """Distance between a joint of fixed bone lengths and the place where the nodes have it at which confidence is one half,
    share of the root of the area; as in `paper_2014`."""


class NodeMotion(NamedTuple):
    """The nodes of the integrated structure in all frames.

    node, joint, parents, cluster : (node, …) at rest, see `graph_body.GraphBody`
    position, rotation            : (frame, node, xyz) · (frame, node, 3, 3)
    """

    node: Floats
    joint: Floats
    parents: Ints
    cluster: Ints
    position: Floats
    rotation: Floats


def edge_joints(
    moving: NodeMotion, V: Floats, label: Ints, bound: Ints, weight: Floats, end: Ints, leaf_vertex: Ints, size: float,
    settings: EdgeJointsSettings | None = None,
) -> KinematicTree:  # fmt: skip
    """The skeleton of clusters: a joint at each edge between two, a bone's end at each leaf, lengths fixed.

    V, label           : (vertex, xyz) mesh unit · (vertex,) node · bound, weight : (vertex, 4) of nodes
    end, leaf_vertex   : (leaf,) node · (leaf,) vertex
    """
    first = _first_nodes(moving)
    parts = len(first)
    part = _parts(moving, first)
    parents = np.array([part[moving.parents[n]] if moving.parents[n] >= 0 else -1 for n in first])
    R = np.stack([_turn(moving.rotation[:, part == p]) for p in range(parts)], axis=1)
    offset = (moving.joint - moving.node)[first]
    observed = moving.position[:, first] + np.einsum("tnxy,ny->tnx", moving.rotation[:, first], offset)
    rest = np.concatenate([moving.joint[first], V[leaf_vertex]])
    above = np.concatenate([parents, part[end]])
    carrier = np.concatenate([np.arange(parts), part[end]])
    is_end = np.arange(len(above)) >= parts
    X = _placed(rest, above, carrier, R, _root_place(moving, part, rest[0], R[:, 0]))
    order, names = joint_names(rest, above, is_end)
    place = np.argsort(order)
    distance = np.concatenate([np.linalg.norm(X[:, :parts] - observed, axis=2), np.zeros((len(X), len(end)))], axis=1)
    half = (settings or EdgeJointsSettings()).half_confidence * size
    turned = R[:, carrier]
    influence, share = _skin(part, bound, weight, parts)
    new_parents = np.where(above[order] >= 0, place[above[order]], -1)
    turns: Flags = ~is_end[order] & (new_parents >= 0)
    return KinematicTree(
        names=names,
        kinds=tuple("leaf" if is_end[j] else "joint" if above[j] >= 0 else "root" for j in order),
        parents=new_parents,
        rest=rest[order],
        positions=X[:, order],
        rotation=turned[:, order],
        confidence=(1.0 / (1.0 + (distance / half) ** 2))[:, order],
        degrees=joint_degrees(turned[:, order], new_parents, turns),
        drift=np.sqrt((distance**2).mean(axis=0))[order],
        support=np.full(len(order), len(X)),
        label=place[part[label]],
        influence=np.where(share > 0, place[influence], 0),
        weight=share,
    )


def _first_nodes(moving: NodeMotion) -> Ints:
    """(part,) the node nearest to the root of each connected piece of a cluster."""
    p = moving.parents
    return np.array([n for n in range(len(p)) if p[n] < 0 or moving.cluster[n] != moving.cluster[p[n]]], np.int64)


def _parts(moving: NodeMotion, first: Ints) -> Ints:
    """(node,) part."""
    part = np.full(len(moving.parents), -1)
    part[first] = np.arange(len(first))
    for n in range(len(part)):
        if part[n] < 0:
            part[n] = part[moving.parents[n]]
    return part


def _turn(R: Floats) -> Floats:
    """(frame, 3, 3) the mean rotation of some nodes (frame, node, 3, 3)."""
    return np.stack([nearest_rotation(r) for r in R.mean(axis=1)])


def _root_place(moving: NodeMotion, part: Ints, rest: Floats, R: Floats) -> Floats:
    """(frame, xyz) the root's joint as the nodes of the root's cluster carry it in the mean."""
    own = part == 0
    middle = moving.position[:, own].mean(axis=1)
    return np.asarray(middle + R @ (rest - moving.node[own].mean(axis=0)), dtype=np.float64)


def _placed(rest: Floats, above: Ints, carrier: Ints, R: Floats, root: Floats) -> Floats:
    """(frame, joint, xyz) joints from the root outwards with bones of fixed length."""
    X = np.empty((len(R), len(rest), 3))
    X[:, 0] = root
    for j in range(1, len(rest)):
        X[:, j] = X[:, above[j]] + R[:, carrier[above[j]]] @ (rest[j] - rest[above[j]])
    return X


def _skin(part: Ints, bound: Ints, weight: Floats, parts: int) -> tuple[Ints, Floats]:
    """(vertex, 4) parts and weights, from those of nodes."""
    W = np.zeros((len(bound), parts))
    np.add.at(W, (np.arange(len(bound))[:, None], part[bound]), weight)
    return heaviest(few(W))
