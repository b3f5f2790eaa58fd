"""The body with joints that are assumed, as a rig has them (ours)."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kinetree.schemas.array import Floats
from kinetree.schemas.results.assumed_joints import AssumedJoint, AssumedJoints
from kinetree.schemas.results.complete_skeleton import CompleteSkeleton
from kinetree.schemas.structure.joint_names import JointNames

NOTHING_ASSUMED = AssumedJoints()


class Rig(NamedTuple):
    """A skeleton, its names, and which of its joints are assumed."""

    skeleton: CompleteSkeleton
    names: JointNames
    assumed: frozenset[int] = frozenset()


def with_assumed(skeleton: CompleteSkeleton, names: JointNames, assumed: AssumedJoints) -> Rig:
    """The same motion of the same surface with each assumed joint on its bone, which ends there and goes on.

    The joint moves as its bone does, so it never turns; its confidence is 0. The surface keeps its weights: no vertex follows
    an assumed joint.
    """
    if not assumed.joints:
        return Rig(skeleton, names)
    order = _order(len(skeleton.names), assumed)
    added = frozenset(n for n, joint in enumerate(order) if isinstance(joint, AssumedJoint))
    number = {joint: n for n, joint in enumerate(order) if isinstance(joint, int)}
    parents = [_above(n, order, number, skeleton.parents) for n in range(len(order))]
    new = np.array([number[j] for j in range(len(number))])
    fields = {
        "names": tuple(f"assumed_{j.anatomy}" if isinstance(j, AssumedJoint) else skeleton.names[j] for j in order),
        "parents": tuple(parents),
        "kinds": tuple("joint" if isinstance(j, AssumedJoint) else skeleton.kinds[j] for j in order),
        "positions": _between(np.asarray(skeleton.positions), order, skeleton.parents),
        "rest": _between(np.asarray(skeleton.rest), order, skeleton.parents),
        "rotation": skeleton.rotation[:, [skeleton.parents[j.child] if isinstance(j, AssumedJoint) else j for j in order]],
        "confidence": _or_zero(skeleton.confidence, order),
        "degrees": _or_zero(skeleton.degrees, order),
        "drift": _or_zero(skeleton.drift, order),
        "support": _or_zero(skeleton.support, order),
        "label": np.where(skeleton.label < 0, -1, new[skeleton.label]).astype(skeleton.label.dtype),
        "influence": new[skeleton.influence].astype(skeleton.influence.dtype),
    }
    told = {
        "given": fields["names"],
        "names": tuple(j.name if isinstance(j, AssumedJoint) else names.names[j] for j in order),
        "anatomy": tuple(j.anatomy if isinstance(j, AssumedJoint) else names.anatomy[j] for j in order),
    }
    return Rig(skeleton.model_copy(update=fields), names.model_copy(update=told), added)


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


def _between(X: Floats, order: list[int | AssumedJoint], parents: tuple[int, ...]) -> Floats:
    """(…, joint, xyz) positions of all joints, of assumed ones on the line between the ends of their bones."""
    rows = []
    for j in order:
        if isinstance(j, AssumedJoint):
            rows.append((1.0 - j.share) * X[..., parents[j.child], :] + j.share * X[..., j.child, :])
        else:
            rows.append(X[..., j, :])
    return np.stack(rows, axis=-2)


def _or_zero(values: NDArray[Any], order: list[int | AssumedJoint]) -> NDArray[Any]:
    """(…, joint) what is measured of the joints, 0 for assumed ones."""
    known = np.array([0 if isinstance(j, AssumedJoint) else j for j in order])
    measured = np.array([not isinstance(j, AssumedJoint) for j in order])
    return np.asarray(np.where(measured, values[..., known], 0), values.dtype)
