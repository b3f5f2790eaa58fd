"""The body with joints that are assumed, as a rig has them (ours)."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kinetree.schemas.array import Floats, Ints
from kinetree.schemas.results.assumed_joints import AssumedJoint, AssumedJoints
from kinetree.schemas.results.complete_skeleton import CompleteSkeleton
from kinetree.schemas.structure.joint_names import JointNames
from kinetree.tasks.numerics.results.limb_sections import share_beyond
from kinetree.tasks.results.formats.rig import carried

NOTHING_ASSUMED = AssumedJoints()


class Rig(NamedTuple):
    """A skeleton, its names, and which of its joints are assumed."""

    skeleton: CompleteSkeleton
    names: JointNames
    assumed: frozenset[int] = frozenset()


def with_assumed(skeleton: CompleteSkeleton, names: JointNames, assumed: AssumedJoints) -> Rig:
    """The same motion of the same surface with each assumed joint in its limb, whose bone ends there and goes on.

    The joint moves as its bone does, so it never turns; its confidence is 0. The surface beyond it follows it in place of the
    joint before it, smoothly around the joint, and so bends where the joint is bent; parts keep their labels.
    """
    if not assumed.joints:
        return Rig(skeleton, names)
    order = _order(len(skeleton.names), assumed)
    added = frozenset(n for n, joint in enumerate(order) if isinstance(joint, AssumedJoint))
    number = {joint: n for n, joint in enumerate(order) if isinstance(joint, int)}
    parents = [_above(n, order, number, skeleton.parents) for n in range(len(order))]
    new = np.array([number[j] for j in range(len(number))])
    rest = np.stack([np.array(j.place) if isinstance(j, AssumedJoint) else skeleton.rest[j] for j in order])
    fields = {
        "names": tuple(f"assumed_{j.anatomy}" if isinstance(j, AssumedJoint) else skeleton.names[j] for j in order),
        "parents": tuple(parents),
        "kinds": tuple("joint" if isinstance(j, AssumedJoint) else skeleton.kinds[j] for j in order),
        "positions": _positions(skeleton, order),
        "rest": rest,
        "rotation": skeleton.rotation[:, [skeleton.parents[j.child] if isinstance(j, AssumedJoint) else j for j in order]],
        "confidence": _or_zero(skeleton.confidence, order),
        "degrees": _or_zero(skeleton.degrees, order),
        "drift": _or_zero(skeleton.drift, order),
        "support": _or_zero(skeleton.support, order),
        "label": np.where(skeleton.label < 0, -1, new[skeleton.label]).astype(skeleton.label.dtype),
        **_weights(skeleton, order, parents, rest, new),
    }
    spellings = {
        "given": fields["names"],
        "names": tuple(j.name if isinstance(j, AssumedJoint) else names.names[j] for j in order),
        "anatomy": tuple(j.anatomy if isinstance(j, AssumedJoint) else names.anatomy[j] for j in order),
    }
    return Rig(skeleton.model_copy(update=fields), names.model_copy(update=spellings), added)


def _order(count: int, assumed: AssumedJoints) -> list[int | AssumedJoint]:
    """All joints, those of the skeleton by number, each assumed joint before the one at the outer end of its bone."""
    order: list[int | AssumedJoint] = []
    for j in range(count):
        order += [*sorted((a for a in assumed.joints if a.child == j), key=lambda a: a.share), j]
    return order


def _above(n: int, order: list[int | AssumedJoint], number: dict[int, int], parents: tuple[int, ...]) -> int:
    """The new parent of a joint: the one before it where both lie on one bone, else that of the bone; −1 for the root."""
    joint, before = order[n], order[n - 1] if n else None
    child = joint.child if isinstance(joint, AssumedJoint) else joint
    if isinstance(before, AssumedJoint) and before.child == child:
        return n - 1
    return number[parents[child]] if parents[child] >= 0 else -1


def _positions(skeleton: CompleteSkeleton, order: list[int | AssumedJoint]) -> Floats:
    """(frame, joint, xyz) positions of all joints; assumed ones move with the part of their bone."""
    assumed = [j for j in order if isinstance(j, AssumedJoint)]
    places = carried(skeleton, [skeleton.parents[j.child] for j in assumed], np.array([j.place for j in assumed]))
    known = np.asarray(skeleton.positions)
    return np.stack([places[:, assumed.index(j)] if isinstance(j, AssumedJoint) else known[:, j] for j in order], axis=1)


def _weights(
    skeleton: CompleteSkeleton, order: list[int | AssumedJoint], parents: list[int], rest: Floats, new: Ints
) -> dict[str, NDArray[Any]]:
    """Influences and weights in which what lies beyond an assumed joint follows it, in place of the joint before it.

    Both have the same motion, so the surface moves as before. A vertex that follows four joints already follows the heavier of
    the two.
    """
    V, F = np.asarray(skeleton.vertices), np.asarray(skeleton.faces, np.int64)
    joint, weight = new[np.asarray(skeleton.influence)], np.array(skeleton.weight)
    vertex = np.arange(len(V))
    for n, assumed in enumerate(order):
        if not isinstance(assumed, AssumedJoint):
            continue
        after = next(c for c in range(n + 1, len(order)) if parents[c] == n)
        beyond = share_beyond(V, F, rest[n], rest[parents[n]], rest[after])
        slot = np.argmax((joint == parents[n]) & (weight > 0.0), axis=1)
        carried = np.where(joint[vertex, slot] == parents[n], weight[vertex, slot], 0.0)
        free = np.argmin(weight, axis=1)
        full = weight[vertex, free] > 0.0
        beyond = np.where(full, np.rint(beyond), beyond)
        moved = carried * beyond
        whole = (moved > 0.0) & (moved == carried)
        joint[vertex[whole], slot[whole]] = n
        split = (moved > 0.0) & ~whole
        weight[vertex[split], slot[split]] -= moved[split]
        joint[vertex[split], free[split]] = n
        weight[vertex[split], free[split]] = moved[split]
    heaviest = np.argsort(-weight, axis=1, kind="stable")
    joint, weight = np.take_along_axis(joint, heaviest, axis=1), np.take_along_axis(weight, heaviest, axis=1)
    return {"influence": joint.astype(skeleton.influence.dtype), "weight": weight}


def _or_zero(values: NDArray[Any], order: list[int | AssumedJoint]) -> NDArray[Any]:
    """(…, joint) what is measured of the joints, 0 for assumed ones."""
    known = np.array([0 if isinstance(j, AssumedJoint) else j for j in order])
    measured = np.array([not isinstance(j, AssumedJoint) for j in order])
    return np.asarray(np.where(measured, values[..., known], 0), values.dtype)
