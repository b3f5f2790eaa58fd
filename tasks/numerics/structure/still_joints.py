"""The posed tree with joints that no motion shows: they turn by nothing (ours: `necks`, `narrowings`, `mirrored_joints`)."""

from collections.abc import Sequence
from enum import IntEnum
from typing import Any, NamedTuple, TypeVar

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.structure.articulated_fit import Motion

A = TypeVar("A", bound=np.ndarray[Any, Any])


class Still(IntEnum):
    """What shows a joint that no motion shows."""

    NO = 0
    """It is no such joint: motion shows it."""
    NECK = 1
    MIRRORED = 2
    NARROWING = 3


class StillJoint(NamedTuple):
    """A joint to be added at one end of a piece of a part, or of a tube before it; the part's own joint is at the other end, or
    amid the tube.

    part   : in the tree's order
    above  : whether the joint is at the end towards the part above
    centre : (xyz,) of the joint in the reference, mesh unit
    radius : of the ring there, mesh unit
    share  : (vertex,) how much each vertex follows the piece between both joints, 0 to 1
    """

    part: int
    above: bool
    centre: Floats
    radius: float
    share: Floats


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
    carrier    : (part,) part of the first tree whose motion it has: itself but for the piece before a joint that is added
    still      : (part,) what shows its joint, a `Still`
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
    still: Ints


def with_still_joints(tree: PosedTree, joints: Sequence[StillJoint], shown_by: Still) -> PosedTree:
    """The tree with one joint more in every part given, and the piece between both joints right before what is beyond it.

    That piece moves as it did. So the new joint turns by nothing, and the other joint and the skin stay as they were. No motion
    says where the new joint is: it has no drift, spread or offset. Frames show it as they show the other joint.

    joints : one at least, by part, at most one in a part
    """
    below = np.array([one.part for one in joints])
    above = tree.parents[below]
    place = np.arange(len(tree.parents)) + np.searchsorted(below, np.arange(len(tree.parents)), side="right")
    own = place[below] - 1
    is_above = np.array([one.above for one in joints])
    new, moved_by = np.where(is_above, own, own + 1), np.where(is_above, above, below)
    parents = np.insert(np.where(tree.parents < 0, -1, place[tree.parents]), below, 0)
    parents[own], parents[own + 1] = parents[own + 1], own
    label, W = _skinned(tree, joints, place, moved_by)
    motion = tree.motion._replace(
        rest=_with(tree.motion.rest, below, new, np.stack([one.centre for one in joints])),
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
        radius=_with(tree.radius, below, new, np.array([one.radius for one in joints])),
        offset=_with(tree.offset, below, new, np.full(len(below), np.nan)),
        hinge=_with(tree.hinge, below, new, np.full(len(below), np.nan)),
        spread=_with(tree.spread, below, new, np.full(len(below), np.nan)),
        agreeing=_with(tree.agreeing, below, new, np.ones(len(below), np.int64)),
        place=np.where(tree.place < 0, -1, place[tree.place]),
        carrier=np.insert(tree.carrier, below, tree.carrier[moved_by]),
        still=_with(tree.still, below, new, np.full(len(below), shown_by)),
    )


def _with(known: A, below: Ints, new: Ints, value: A) -> A:
    """What is known of joints, with a row for every new one: that is `value`."""
    rows = np.insert(known, below, known[below], axis=0)
    rows[new] = value
    return rows


def _skinned(tree: PosedTree, joints: Sequence[StillJoint], place: Ints, moved_by: Ints) -> tuple[Ints, Floats]:
    """(vertex,) part · (vertex, part) skinning weights: the piece between both joints takes its skin of what moved it."""
    label, W = place[tree.label], np.insert(tree.W, [one.part for one in joints], 0.0, axis=1)
    for one, part in zip(joints, moved_by, strict=True):
        own, old = place[one.part] - 1, place[part]
        W[:, own] = one.share * W[:, old]
        W[:, old] *= 1.0 - one.share
        label[(one.share > 0.5) & (tree.label == part)] = own
    return label, W
