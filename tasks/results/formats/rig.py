"""What every format that moves bones needs: rest orientations along the bones, and how each joint turns against its parent."""

from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import Rotation

from kinetree.schemas.array import Floats
from kinetree.schemas.structure.skeleton import Skeleton

OPPOSITE = 1e-6
"""Below this length of their sum two directions are opposite."""


def children(parents: Sequence[int]) -> list[list[int]]:
    """Per joint the joints whose parent it is, in their own order."""
    found: list[list[int]] = [[] for _ in parents]
    for joint, parent in enumerate(parents):
        if parent >= 0:
            found[parent].append(joint)
    return found


def rest_frames(rest: Floats, parents: Sequence[int]) -> Floats:
    """Orientation of every joint in the reference pose: y along its bone, turned out of its parent's by the least turn.

    The bone of a joint with several children leads to the one with the longest bones, all below it counted; a leaf goes on
    as its parent does, and so does a bone without length. The root starts from the axes of space.

    rest    : (joint, xyz) mesh unit
    parents : parents first, −1 for the root
    returns : (joint, 3, 3), columns are the axes
    """
    below = children(parents)
    reach = np.zeros(len(parents))
    for joint in reversed(range(1, len(parents))):
        reach[joint] = np.linalg.norm(rest[joint] - rest[parents[joint]]) + sum(reach[c] for c in below[joint])
    B = np.empty((len(parents), 3, 3))
    for joint, parent in enumerate(parents):
        before = B[parent] if parent >= 0 else np.eye(3)
        ahead = max(below[joint], key=lambda c: (reach[c], -c), default=joint)
        B[joint] = _turned(before, rest[ahead] - rest[joint])
    return B


def local_rotations(R: Floats, B: Floats, parents: Sequence[int]) -> Floats:
    """Turn of every joint against its parent, both in their rest orientations: (R_p B_p)ᵀ R_j B_j.

    R       : (frame, joint, 3, 3) from the reference pose to each frame
    B       : (joint, 3, 3) rest orientations
    returns : (frame, joint, 3, 3)
    """
    G = R @ B
    turns = [G[:, j] if p < 0 else G[:, p].transpose(0, 2, 1) @ G[:, j] for j, p in enumerate(parents)]
    return np.stack(turns, axis=1)


def local_offsets(rest: Floats, B: Floats, parents: Sequence[int]) -> Floats:
    """(joint, xyz) every joint as its parent in rest orientation sees it, B_pᵀ (rest_j − rest_p); the root in space."""
    return np.stack([rest[j] if p < 0 else B[p].T @ (rest[j] - rest[p]) for j, p in enumerate(parents)])


def quaternions(R: Floats) -> Floats:
    """(frame, …, 3, 3) → (frame, …, xyzw) unit; of the two that mean one turn the one nearer to the frame before."""
    q = np.asarray(Rotation.from_matrix(R.reshape(-1, 3, 3)).as_quat()).reshape(*R.shape[:-2], 4)
    flips = np.sum(q[1:] * q[:-1], axis=-1) < 0
    q[1:] *= np.where(np.cumsum(flips, axis=0) % 2, -1.0, 1.0)[..., None]
    return q


def seconds(skeleton: Skeleton, fps: float) -> Floats:
    """(frame,) since the first frame; frames left out leave a gap."""
    return (np.array(skeleton.frames, np.float64) - skeleton.frames[0]) / fps


def skinned(skeleton: Skeleton, t: int) -> Floats:
    """(vertex, xyz) the reference mesh as the skeleton carries it in its t-th frame, Σ_i w_vi [R_i (v − rest_i) + x_i]."""
    at = skeleton.influence
    moved = np.einsum("vixy,viy->vix", skeleton.rotation[t][at], skeleton.vertices[:, None] - skeleton.rest[at])
    out: Floats = np.einsum("vi,vix->vx", skeleton.weight, moved + skeleton.positions[t][at])
    return out


def _turned(frame: Floats, along: Floats) -> Floats:
    """A frame turned by the least turn that takes its y axis along a direction: mirrored across y, then across what halves."""
    length = float(np.linalg.norm(along))
    if length == 0.0:
        return frame
    y, d = frame[:, 1], along / length
    half = y + d
    if np.linalg.norm(half) < OPPOSITE:
        return np.asarray(frame * np.array([1.0, -1.0, -1.0]))
    half /= np.linalg.norm(half)
    mirrored = frame - 2.0 * np.outer(y, y @ frame)
    return np.asarray(mirrored - 2.0 * np.outer(half, half @ mirrored))
