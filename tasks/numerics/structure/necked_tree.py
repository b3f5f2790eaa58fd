"""The posed tree with a bone in every neck that the shape alone shows (ours, see `necks`)."""

from collections.abc import Sequence
from typing import NamedTuple, TypeVar

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.structure.articulated_fit import Motion
from kinetree.tasks.numerics.structure.necks import Neck

A = TypeVar("A", Floats, Ints)


class PosedTree(NamedTuple):
    """A tree in every frame, and what is known of its joints.

    parents    : (part,) −1 for the root
    motion     : `rest` in the reference; rotations of all parts and positions of the root
    label      : (vertex,) part
    W          : (vertex, part) skinning weights
    confidence : (frame, part) 0 to 1
    drift      : (part,) see `FirstTree`, mesh unit
    support    : (part,) frames that show both parts of a joint
    residual   : (part,) see `FirstTree`, mesh unit
    radius     : (part,) of the border at each joint, mesh unit
    offset     : (part,) see `SurfaceJoints`, mesh unit
    hinge      : (part,) see `SurfaceJoints`, mesh unit
    spread     : (part,) see `JointConsensus`, mesh unit
    agreeing   : (part,) cuts that have each
    place      : (first part,) part, −1 where it was dropped
    carrier    : (part,) part of the first tree whose motion it has: itself but for a neck
    is_neck    : (part,) whether the shape alone shows its joint
    """

    parents: Ints
    motion: Motion
    label: Ints
    W: Floats
    confidence: Floats
    drift: Floats
    support: Ints
    residual: Floats
    radius: Floats
    offset: Floats
    hinge: Floats
    spread: Floats
    agreeing: Ints
    place: Ints
    carrier: Ints
    is_neck: Flags


def necked_tree(tree: PosedTree, necks: Sequence[Neck]) -> PosedTree:
    """The tree with every neck right before the part that hangs on it.

    A neck moves as the tube did, with one of the parts at its ends. So the new joint turns by nothing, and the other joint and
    the skin stay as they were. Only the shape says where the new joint is: it has no drift, spread or offset. Frames show it
    as they show the other joint.

    necks : one at least, by part
    """
    below = np.array([neck.part for neck in necks])
    above = tree.parents[below]
    place = np.arange(len(tree.parents)) + np.searchsorted(below, np.arange(len(tree.parents)), side="right")
    own = place[below] - 1
    is_above = np.array([neck.above for neck in necks])
    new, moved_by = np.where(is_above, own, own + 1), np.where(is_above, above, below)
    parents = np.insert(np.where(tree.parents < 0, -1, place[tree.parents]), below, 0)
    parents[own], parents[own + 1] = parents[own + 1], own
    label, W = _skinned(tree, necks, place, moved_by)
    motion = tree.motion._replace(
        rest=_with(tree.motion.rest, below, new, np.stack([neck.centre for neck in necks])),
        R=np.insert(tree.motion.R, below, tree.motion.R[:, moved_by], axis=1),
    )
    return PosedTree(
        parents=parents,
        motion=motion,
        label=label,
        W=W,
        confidence=np.insert(tree.confidence, below, tree.confidence[:, below], axis=1),
        drift=_with(tree.drift, below, new, np.zeros(len(below))),
        support=np.insert(tree.support, below, tree.support[below]),
        residual=_with(tree.residual, below, new, np.zeros(len(below))),
        radius=_with(tree.radius, below, new, np.array([neck.radius for neck in necks])),
        offset=_with(tree.offset, below, new, np.full(len(below), np.nan)),
        hinge=_with(tree.hinge, below, new, np.full(len(below), np.nan)),
        spread=_with(tree.spread, below, new, np.full(len(below), np.nan)),
        agreeing=_with(tree.agreeing, below, new, np.ones(len(below), np.int64)),
        place=np.where(tree.place < 0, -1, place[tree.place]),
        carrier=np.insert(tree.carrier, below, tree.carrier[moved_by]),
        is_neck=np.isin(np.arange(len(parents)), new),
    )


def _with(known: A, below: Ints, new: Ints, value: A) -> A:
    """What is known of joints, with a row for every neck: that of its new joint is `value`."""
    rows = np.insert(known, below, known[below], axis=0)
    rows[new] = value
    return rows


def _skinned(tree: PosedTree, necks: Sequence[Neck], place: Ints, moved_by: Ints) -> tuple[Ints, Floats]:
    """(vertex,) part · (vertex, part) skinning weights: of its tube a neck takes the skin of the part that moved it."""
    label, W = place[tree.label], np.insert(tree.W, [neck.part for neck in necks], 0.0, axis=1)
    for neck, part in zip(necks, moved_by, strict=True):
        own, old = place[neck.part] - 1, place[part]
        W[:, own] = neck.share * W[:, old]
        W[:, old] *= 1.0 - neck.share
        label[(neck.share > 0.5) & (tree.label == part)] = own
    return label, W
