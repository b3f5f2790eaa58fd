"""Lengths of bones as the rigid parts alone carry their ends, before every bone is given one length (2014, Fig. 15; ours)."""

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints


def free_bone_lengths(rest: Floats, parents: Ints, part: Ints, R: Floats, t: Floats) -> Floats:
    """Length of every bone in every frame; a joint is where its two parts carry it in the mean.

    rest    : (joint, xyz) in the reference, mesh unit
    parents : (joint,) −1 for the root
    part    : (joint,) rigid part that turns about each joint, −1 for the end of a bone, which moves with its parent's
    R, t    : (frame, part, 3, 3) · (frame, part, xyz) from the reference to each frame
    returns : (frame, joint) from each joint to its parent, mesh unit; 0 for the root
    """
    above = np.where(parents < 0, part, part[np.maximum(parents, 0)])
    own = np.where(part < 0, above, part)
    one, other = (np.einsum("tjxy,jy->tjx", R[:, p], rest) + t[:, p] for p in (own, above))
    X = (one + other) / 2
    length: Floats = np.linalg.norm(X - X[:, np.maximum(parents, 0)], axis=2)
    return np.where(parents < 0, 0.0, length)
