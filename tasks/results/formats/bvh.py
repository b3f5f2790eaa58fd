"""A skeleton's motion as BVH: a tree of constant offsets, then one line of angles a frame."""

import math
from collections.abc import Iterator

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from kinetree.schemas.array import Floats
from kinetree.schemas.results.glb import ASSUMED_FPS
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.results.formats.names import identifiers
from kinetree.tasks.results.formats.rig import children, local_rotations

TURNS = "Zrotation Xrotation Yrotation"
LEVEL = 1e-7
"""Below this cosine of the middle angle the other two turn about one axis."""


def bvh(skeleton: Skeleton) -> tuple[str, int]:
    """The text of a BVH file, and how many frames were put in between those of the sequence.

    The rest pose is the reference pose, in which nothing is turned; the root has no offset and is moved by its channels
    alone. A leaf that is its parent's only child is the parent's end site; other leaves are joints that never turn, since
    programs expect one end site at most and none beside joints.
    """
    step = math.gcd(*np.diff(skeleton.frames).tolist()) if len(skeleton.frames) > 1 else 1
    position, local = _evenly(skeleton, step)
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
    """(…, 3, 3) → (…, 3) degrees (a, b, c) with R = Rz(a) Rx(b) Ry(c); c = 0 where a and c turn about one axis."""
    sine = np.clip(R[..., 2, 1], -1.0, 1.0)
    level = np.hypot(R[..., 2, 0], R[..., 2, 2]) < LEVEL
    a = np.where(level, np.arctan2(R[..., 1, 0], R[..., 0, 0]), np.arctan2(-R[..., 0, 1], R[..., 1, 1]))
    c = np.where(level, 0.0, np.arctan2(-R[..., 2, 0], R[..., 2, 2]))
    b = np.arctan2(sine, np.hypot(R[..., 2, 0], R[..., 2, 2]))
    return np.asarray(np.degrees(np.stack([a, b, c], axis=-1)))


def continuous(angles: Floats) -> Floats:
    """The same turns with angles that go on from frame to frame, whole turns and (a ± 180°, 180° − b, c ± 180°) being equal.

    angles  : (frame, joint, 3) degrees as `euler_zxy` gives them
    returns : (frame, joint, 3) degrees
    """
    out = np.array(angles)
    for t in range(1, len(out)):
        near = [a + 360.0 * np.rint((out[t - 1] - a) / 360.0) for a in (out[t], [180.0, 180.0, 180.0] + out[t] * [1, -1, 1])]
        far = [np.abs(a - out[t - 1]).sum(axis=-1, keepdims=True) for a in near]
        out[t] = np.where(far[1] < far[0], near[1], near[0])
    return out


def _evenly(skeleton: Skeleton, step: int) -> tuple[Floats, Floats]:
    """The root's position and every joint's turn against its parent, at every multiple of the step."""
    still = np.broadcast_to(np.eye(3), skeleton.rotation.shape[1:])
    local = local_rotations(skeleton.rotation, still, skeleton.parents)
    given = np.array(skeleton.frames)
    wanted = np.arange(given[0], given[-1] + 1, step)
    if len(wanted) == len(given):
        return skeleton.positions[:, 0], local
    position = np.stack([np.interp(wanted, given, skeleton.positions[:, 0, x]) for x in range(3)], axis=1)
    turns = [Slerp(given, Rotation.from_matrix(local[:, j]))(wanted).as_matrix() for j in range(local.shape[1])]
    return position, np.stack(turns, axis=1)


def _tree(skeleton: Skeleton, below: list[list[int]], names: list[str], joint: int, depth: int) -> Iterator[str]:
    pad, parent = "  " * depth, skeleton.parents[joint]
    offset = np.zeros(3) if parent < 0 else skeleton.rest[joint] - skeleton.rest[parent]
    is_end = _is_end(skeleton, below, joint)
    yield f"{pad}End Site" if is_end else f"{pad}{'ROOT' if parent < 0 else 'JOINT'} {names[joint]}"
    yield f"{pad}{{"
    yield f"{pad}  OFFSET {' '.join(_number(x) for x in offset)}"
    if not is_end:
        yield f"{pad}  CHANNELS " + (f"6 Xposition Yposition Zposition {TURNS}" if parent < 0 else f"3 {TURNS}")
        for child in below[joint]:
            yield from _tree(skeleton, below, names, child, depth + 1)
        if not below[joint]:
            yield from (f"{pad}  End Site", f"{pad}  {{", f"{pad}    OFFSET 0 0 0", f"{pad}  }}")
    yield f"{pad}}}"


def _is_end(skeleton: Skeleton, below: list[list[int]], joint: int) -> bool:
    return skeleton.kinds[joint] == "leaf" and below[skeleton.parents[joint]] == [joint]


def _depth_first(below: list[list[int]]) -> Iterator[int]:
    """The joints in the order in which the tree is written, which is that of the channels."""
    waiting = [0]
    while waiting:
        joint = waiting.pop()
        yield joint
        waiting += reversed(below[joint])


def _number(x: float) -> str:
    return f"{x + 0.0:.9g}"
