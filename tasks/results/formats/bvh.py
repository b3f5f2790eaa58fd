"""The motion of a skeleton as BVH: a tree of constant offsets, then one line of angles a frame (ours)."""

import math
from collections.abc import Iterator

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from kinetree.schemas.array import Floats
from kinetree.schemas.results.glb import ASSUMED_FPS
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.results.formats.names import identifiers
from kinetree.tasks.results.formats.rig import children, local_rotations

ROTATIONS = "Zrotation Xrotation Yrotation"
GIMBAL_COSINE = 1e-7
"""Cosine of the middle angle below which the other two angles turn about one axis."""


def bvh(skeleton: Skeleton) -> tuple[str, int]:
    """The text of a BVH file, and the number of interpolated frames.

    The rest pose is the reference pose, with all angles 0. The root has no offset; only its channels move it. A leaf that is
    its parent's only child is the parent's end site. Other leaves are joints that never turn, because programs expect at most
    one end site a joint, and none beside joints.
    """
    step = math.gcd(*np.diff(skeleton.frames).tolist()) if len(skeleton.frames) > 1 else 1
    position, local = _at_even_steps(skeleton, step)
    below = children(skeleton.parents)
    turning = [j for j in _depth_first(below) if not _is_end(skeleton, below, j)]
    angles = continuous(euler_zxy(local[:, turning]))
    rows = np.concatenate([position, np.round(angles.reshape(len(angles), -1), 7)], axis=1)
    motion = [" ".join(_number(x) for x in row) for row in rows]
    frame_time = step / (skeleton.fps or ASSUMED_FPS)
    head = ["HIERARCHY", *_tree(skeleton, below, identifiers(skeleton.names), 0, 0)]
    lines = [*head, "MOTION", f"Frames: {len(rows)}", f"Frame Time: {frame_time:.9g}", *motion]
    return "\n".join(lines) + "\n", len(rows) - len(skeleton.frames)


def euler_zxy(R: Floats) -> Floats:
    """Angles (a, b, c) with R = Rz(a) Rx(b) Ry(c); c = 0 where a and c turn about one axis.

    R       : (…, 3, 3) rotations
    returns : (…, 3) degrees
    """
    sine = np.clip(R[..., 2, 1], -1.0, 1.0)
    gimbal = np.hypot(R[..., 2, 0], R[..., 2, 2]) < GIMBAL_COSINE
    a = np.where(gimbal, np.arctan2(R[..., 1, 0], R[..., 0, 0]), np.arctan2(-R[..., 0, 1], R[..., 1, 1]))
    c = np.where(gimbal, 0.0, np.arctan2(-R[..., 2, 0], R[..., 2, 2]))
    b = np.arctan2(sine, np.hypot(R[..., 2, 0], R[..., 2, 2]))
    return np.asarray(np.degrees(np.stack([a, b, c], axis=-1)))


def continuous(angles: Floats) -> Floats:
    """The same rotations with angles that change least from frame to frame.

    Whole turns may be added to any angle, and (a ± 180°, 180° − b, c ± 180°) is the same rotation.

    angles  : (frame, joint, 3) degrees as `euler_zxy` gives them
    returns : (frame, joint, 3) degrees
    """
    nearest = np.array(angles)
    for t in range(1, len(nearest)):
        before, equal = nearest[t - 1], (nearest[t], [180.0, 180.0, 180.0] + nearest[t] * [1, -1, 1])
        choices = [a + 360.0 * np.rint((before - a) / 360.0) for a in equal]
        change = [np.abs(a - before).sum(axis=-1, keepdims=True) for a in choices]
        nearest[t] = np.where(change[1] < change[0], choices[1], choices[0])
    return nearest


def _at_even_steps(skeleton: Skeleton, step: int) -> tuple[Floats, Floats]:
    """Root position and rotations against the parents at every multiple of the step, interpolated where there is no frame."""
    identity = np.broadcast_to(np.eye(3), skeleton.rotation.shape[1:])
    local = local_rotations(skeleton.rotation, identity, skeleton.parents)
    numbers = np.array(skeleton.frames)
    even = np.arange(numbers[0], numbers[-1] + 1, step)
    if len(even) == len(numbers):
        return skeleton.positions[:, 0], local
    position = np.stack([np.interp(even, numbers, skeleton.positions[:, 0, x]) for x in range(3)], axis=1)
    rotations = [Slerp(numbers, Rotation.from_matrix(local[:, j]))(even).as_matrix() for j in range(local.shape[1])]
    return position, np.stack(rotations, axis=1)


def _tree(skeleton: Skeleton, below: list[list[int]], names: list[str], joint: int, depth: int) -> Iterator[str]:
    """The lines of a joint and all joints below it."""
    pad, parent = "  " * depth, skeleton.parents[joint]
    offset = np.zeros(3) if parent < 0 else skeleton.rest[joint] - skeleton.rest[parent]
    is_end = _is_end(skeleton, below, joint)
    yield f"{pad}End Site" if is_end else f"{pad}{'ROOT' if parent < 0 else 'JOINT'} {names[joint]}"
    yield f"{pad}{{"
    yield f"{pad}  OFFSET {' '.join(_number(x) for x in offset)}"
    if not is_end:
        yield f"{pad}  CHANNELS " + (f"6 Xposition Yposition Zposition {ROTATIONS}" if parent < 0 else f"3 {ROTATIONS}")
        for child in below[joint]:
            yield from _tree(skeleton, below, names, child, depth + 1)
        if not below[joint]:
            yield from (f"{pad}  End Site", f"{pad}  {{", f"{pad}    OFFSET 0 0 0", f"{pad}  }}")
    yield f"{pad}}}"


def _is_end(skeleton: Skeleton, below: list[list[int]], joint: int) -> bool:
    """Whether the joint is written as the end site of its parent."""
    return skeleton.kinds[joint] == "leaf" and below[skeleton.parents[joint]] == [joint]


def _depth_first(below: list[list[int]]) -> Iterator[int]:
    """The joints in the order of the tree and of the channels."""
    waiting = [0]
    while waiting:
        joint = waiting.pop()
        yield joint
        waiting += reversed(below[joint])


def _number(x: float) -> str:
    """A number with nine digits, without a sign for zero."""
    return f"{x + 0.0:.9g}"
