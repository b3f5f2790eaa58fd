"""How much bones change their length over a sequence."""

from collections.abc import Sequence

import numpy as np

from kinetree.tasks.numerics.arrays import Floats


def length_variation(X: Floats, parents: Sequence[int]) -> Floats:
    """Standard deviation of each bone's length over the frames, as a share of its mean; 0 for a rigid bone.

    X       : (frame, joint, xyz) mesh unit
    parents : (joint,) parent of each joint, −1 for a root, which has no bone
    returns : (bone,) share, one for every joint that has a parent, in their order
    """
    ends = np.array([(p, j) for j, p in enumerate(parents) if p >= 0], dtype=np.int64).reshape(-1, 2)
    length = np.linalg.norm(X[:, ends[:, 1]] - X[:, ends[:, 0]], axis=2)
    mean = length.mean(axis=0)
    shares: Floats = np.divide(length.std(axis=0), mean, out=np.zeros_like(mean), where=mean > 0.0)
    return shares
