"""A rest pose by the directions of bones, such as a T-pose (ours)."""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats

LEGS, FEET, ARMS, TRUNK = ("hip", "knee"), ("ankle", "toe"), ("shoulder", "elbow", "wrist", "finger"), ("neck", "head")
"""Stations whose bones point down, ahead, to the side and up."""


class RestPose(NamedTuple):
    """A pose of a skeleton.

    R : (joint, row, xyz) rotation of each joint's part from the reference pose
    X : (joint, xyz) joints, mesh unit
    """

    R: Floats
    X: Floats


def rest_pose(rest: Floats, parents: tuple[int, ...], ahead: tuple[int, ...], root: Floats, target: Floats) -> RestPose:
    """The pose in which bones have given directions; every other joint is rotated as its parent is  (ours).

    A bone is brought to its direction by the least rotation, so that nothing is said about roll.

    rest    : (joint, xyz) in the reference pose, mesh unit
    parents : (joint,) parents first, −1 for the root
    ahead   : (joint,) the child to which a joint's bone leads; the joint itself where there is none
    root    : (row, xyz) rotation of the root's part
    target  : (joint, xyz) unit vector along each joint's bone; NaN where it is not given
    """
    R, X = np.empty((len(rest), 3, 3)), np.array(rest)
    for j, p in enumerate(parents):
        R[j] = root if p < 0 else R[p]
        if p >= 0:
            X[j] = X[p] + R[p] @ (rest[j] - rest[p])
        bone = R[j] @ (rest[ahead[j]] - rest[j])
        length = float(np.linalg.norm(bone))
        if length > 0.0 and np.isfinite(target[j]).all():
            R[j] = least_rotation(bone / length, target[j]) @ R[j]
    return RestPose(R, X)


def least_rotation(a: Floats, b: Floats) -> Floats:
    """The rotation by the smallest angle that brings one unit vector to another (Rodrigues).

    a, b    : (xyz,)
    returns : (row, xyz); by half a turn about some axis across where they are opposite
    """
    axis, cosine = np.cross(a, b), float(a @ b)
    if cosine < -1.0 + 1e-9:
        across = np.cross(a, np.eye(3)[int(np.argmin(np.abs(a)))])
        across /= np.linalg.norm(across)
        return np.asarray(2.0 * np.outer(across, across) - np.eye(3))
    x, y, z = axis
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + K + K @ K / (1.0 + cosine))


def standing_targets(anatomy: tuple[str, ...], up: Floats, front: Floats, arms: float) -> Floats:
    """Directions of a person's bones who stands straight with the arms held away from the trunk  (ours).

    anatomy : (joint,) station and side, such as elbow_l
    up      : (xyz,) unit vector
    front   : (xyz,) horizontal unit vector
    arms    : degrees by which the arms hang below the horizontal: 0 in a T-pose, 45 in an A-pose
    returns : (joint, xyz), NaN for joints that have no direction
    """
    left, down = np.cross(up, front), np.radians(arms)
    target = np.full((len(anatomy), 3), np.nan)
    for j, name in enumerate(anatomy):
        station, side = (name[:-2], name[-1]) if name.endswith(("_l", "_r")) else (name, "")
        if station in LEGS:
            target[j] = -up
        elif station in FEET:
            target[j] = front
        elif station in ARMS:
            target[j] = np.cos(down) * (left if side == "l" else -left) - np.sin(down) * up
        elif station in TRUNK:
            target[j] = up
    return target
