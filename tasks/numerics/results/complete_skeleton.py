"""Poses between measured frames: rotations on the shortest way, the root on a straight line (ours)."""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from kinetree.tasks.numerics.arrays import Floats

CERTAINTY = 0.25
"""Confidence of an interpolated pose, share of the less certain of the two frames around it. Not recorded."""


class Poses(NamedTuple):
    """positions (frame, joint, xyz) mesh unit, rotation (frame, joint, 3, 3), confidence (frame, joint)."""

    positions: Floats
    rotation: Floats
    confidence: Floats


def missing_frames(measured: Sequence[int], dropped: Sequence[int], longest: int) -> list[int]:
    """Numbers that are missing between measured frames, in gaps of at most `longest`, ascending.

    measured : frame numbers, ascending, evenly spaced but for those that are missing
    dropped  : numbers of frames that were there and could not be used
    """
    numbers = sorted({*measured, *dropped})
    step = math.gcd(*(b - a for a, b in pairwise(numbers))) or 1
    gaps = (range(a + step, b, step) for a, b in pairwise(measured))
    return [number for gap in gaps if len(gap) <= longest for number in gap]


def interpolated(frames: Sequence[int], wanted: Sequence[int], poses: Poses, rest: Floats, parents: Sequence[int]) -> Poses:
    """Poses at other frame numbers, with the lengths of the bones at rest.

    frames  : numbers of the poses, ascending
    wanted  : numbers between the first and the last of them; none of theirs
    rest    : (joint, xyz) mesh unit, parents (joint,) before their children, −1 for the root
    """
    above = np.maximum(parents, 0)
    local = np.swapaxes(poses.rotation[:, above], -1, -2) @ poses.rotation
    local[:, 0] = poses.rotation[:, 0]
    R = np.stack([Slerp(frames, Rotation.from_matrix(local[:, j]))(wanted).as_matrix() for j in range(len(rest))], axis=1)
    X = np.empty((len(wanted), len(rest), 3))
    X[:, 0] = np.stack([np.interp(wanted, frames, poses.positions[:, 0, k]) for k in range(3)], axis=1)
    for j in range(1, len(rest)):
        p = parents[j]
        R[:, j] = R[:, p] @ R[:, j]
        X[:, j] = X[:, p] + R[:, p] @ (rest[j] - rest[p])
    after = np.searchsorted(frames, wanted)
    return Poses(X, R, CERTAINTY * np.minimum(poses.confidence[after - 1], poses.confidence[after]))
