"""How joints turn against their parents since the reference pose, signed where a joint turns about one axis (ours)."""

from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import Rotation

from kinetree.tasks.numerics.arrays import Floats

HINGE = 0.8
"""Share of the squared turning about one axis above which a joint counts as a hinge."""
FORWARDS = 0.5
"""Cosine between the way of a hinge's far end and the front above which the turning is forwards or backwards."""


def turning(R: Floats, parents: Sequence[int]) -> Floats:
    """Rotation vectors of joints against their parents since the reference pose, in the axes of space.

    R       : (frame, joint, 3, 3) rotation from the reference pose to each frame
    parents : (joint,) −1 for the root, whose turning is 0
    returns : (frame, joint, xyz) radian
    """
    above = [j if p < 0 else p for j, p in enumerate(parents)]
    against = R[:, above].transpose(0, 1, 3, 2) @ R
    return np.asarray(Rotation.from_matrix(against.reshape(-1, 3, 3)).as_rotvec()).reshape(*R.shape[:2], 3)


def signed_turning(w: Floats, bone: Floats, front: Floats) -> Floats:
    """Angle about the one axis about which a joint turns, positive where the far end of its bone moves forwards.

    The axis is the principal one of the rotation vectors.

    w       : (frame, joint, xyz) rotation vectors, radian
    bone    : (joint, xyz) from each joint to the next one in the reference pose; zeros where there is none
    front   : (xyz,) direction that the body faces in the reference pose, of length 1; zeros where it is not known
    returns : (frame, joint) radian; NaN in columns of joints that turn about several axes, or neither forwards nor backwards
    """
    signed = np.full(w.shape[:2], np.nan)
    for j in range(w.shape[1]):
        power, axes = np.linalg.eigh(w[:, j].T @ w[:, j])
        way = np.cross(axes[:, 2], bone[j])
        length = float(np.linalg.norm(way))
        if power.sum() <= 0 or power[2] < HINGE * power.sum() or length <= FORWARDS * np.linalg.norm(bone[j]):
            continue
        cosine = float(way @ front) / length
        if abs(cosine) >= FORWARDS:
            signed[:, j] = np.sign(cosine) * (w[:, j] @ axes[:, 2])
    return signed
