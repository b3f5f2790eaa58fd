"""Rest orientations along the bones, rotations of joints against their parents, and the skinned mesh: shared by formats."""

from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import Rotation

from kinetree.schemas.array import Floats
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.numerics.results.evaluation.body import blended_skin

OPPOSITE_SUM = 1e-6
"""Length of the sum of two unit vectors below which they count as opposite."""


def children(parents: Sequence[int]) -> list[list[int]]:
    """The children of every joint, ascending.

    parents : (joint,) parent of every joint, −1 for the root
    """
    below: list[list[int]] = [[] for _ in parents]
    for joint, parent in enumerate(parents):
        if parent >= 0:
            below[parent].append(joint)
    return below


def rest_frames(rest: Floats, parents: Sequence[int]) -> Floats:
    """Orientation of every joint in the reference pose: y along its bone, rotated as little as possible from its parent's.

    The bone of a joint with several children leads to the child with the longest bones, all below it counted. A leaf, and a
    bone without length, has its parent's orientation. The root is rotated from the axes of space.

    rest    : (joint, xyz) joints in the reference pose, mesh unit
    parents : (joint,) parents before children, −1 for the root
    returns : (joint, 3, 3), columns are the axes
    """
    ahead = main_children(rest, parents)
    B = np.empty((len(parents), 3, 3))
    for joint, parent in enumerate(parents):
        before = B[parent] if parent >= 0 else np.eye(3)
        B[joint] = _rotated(before, rest[ahead[joint]] - rest[joint])
    return B


def main_children(rest: Floats, parents: Sequence[int]) -> tuple[int, ...]:
    """(joint,) the child with the longest bones, all below it counted; the joint itself where there is none."""
    below = children(parents)
    reach = np.zeros(len(parents))
    for joint in reversed(range(1, len(parents))):
        reach[joint] = np.linalg.norm(rest[joint] - rest[parents[joint]]) + sum(reach[c] for c in below[joint])
    return tuple(max(below[joint], key=lambda c: (reach[c], -c), default=joint) for joint in range(len(parents)))


def local_rotations(R: Floats, B: Floats, parents: Sequence[int]) -> Floats:
    """Rotation of every joint against its parent, both in their rest orientations: (R_p B_p)ᵀ R_j B_j.

    R       : (frame, joint, 3, 3) rotation from the reference pose to each frame
    B       : (joint, 3, 3) rest orientations
    parents : (joint,) parent of every joint, −1 for the root
    returns : (frame, joint, 3, 3)
    """
    G = R @ B
    rotations = [G[:, j] if p < 0 else G[:, p].transpose(0, 2, 1) @ G[:, j] for j, p in enumerate(parents)]
    return np.stack(rotations, axis=1)


def local_offsets(rest: Floats, B: Floats, parents: Sequence[int]) -> Floats:
    """Position of every joint in the coordinates of its parent at rest, B_pᵀ (rest_j − rest_p); the root's own position.

    rest    : (joint, xyz) joints in the reference pose, mesh unit
    B       : (joint, 3, 3) rest orientations
    parents : (joint,) parent of every joint, −1 for the root
    returns : (joint, xyz) mesh unit
    """
    return np.stack([rest[j] if p < 0 else B[p].T @ (rest[j] - rest[p]) for j, p in enumerate(parents)])


def quaternions(R: Floats) -> Floats:
    """Unit quaternions; of the two for one rotation, the one nearer to that of the frame before.

    R       : (frame, …, 3, 3) rotations
    returns : (frame, …, xyzw)
    """
    q = np.asarray(Rotation.from_matrix(R.reshape(-1, 3, 3)).as_quat()).reshape(*R.shape[:-2], 4)
    flips = np.sum(q[1:] * q[:-1], axis=-1) < 0
    q[1:] *= np.where(np.cumsum(flips, axis=0) % 2, -1.0, 1.0)[..., None]
    return q


def seconds(skeleton: Skeleton, fps: float) -> Floats:
    """Time of every frame since the first one; missing frames leave a gap.

    fps     : frames a second
    returns : (frame,) seconds
    """
    return (np.array(skeleton.frames, np.float64) - skeleton.frames[0]) / fps


def skinned(skeleton: Skeleton, t: int) -> Floats:
    """The reference mesh as the skeleton carries it in its t-th frame, by linear blend skinning.

    returns : (vertex, xyz) mesh unit
    """
    s = skeleton
    return blended_skin(s.vertices, s.influence, s.weight, s.rest, s.rotation[t], s.positions[t])


def carried(skeleton: Skeleton, bones: Sequence[int], places: Floats) -> Floats:
    """Where the parts of joints bring places of the reference pose: X_p + R_p (place − rest_p), in every frame.

    bones   : (place,) joint p whose part carries the place
    places  : (place, xyz) mesh unit
    returns : (frame, place, xyz) mesh unit
    """
    p = np.asarray(bones, np.int64)
    offsets = places - np.asarray(skeleton.rest)[p]
    turned = np.einsum("tjyx,jx->tjy", np.asarray(skeleton.rotation)[:, p], offsets)
    return np.asarray(np.asarray(skeleton.positions)[:, p] + turned)


def _rotated(frame: Floats, along: Floats) -> Floats:
    """Axes rotated as little as possible so that y points along a direction: mirrored across y, then across the bisector."""
    length = float(np.linalg.norm(along))
    if length == 0.0:
        return frame
    y, d = frame[:, 1], along / length
    half = y + d
    if np.linalg.norm(half) < OPPOSITE_SUM:
        return np.asarray(frame * np.array([1.0, -1.0, -1.0]))
    half /= np.linalg.norm(half)
    mirrored = frame - 2.0 * np.outer(y, y @ frame)
    return np.asarray(mirrored - 2.0 * np.outer(half, half @ mirrored))
