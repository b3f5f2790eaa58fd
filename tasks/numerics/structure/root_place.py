"""Where the root of a tree of joints lies: amid the limbs that hang on it, as the hips of a rig do (ours)."""

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints


def root_amid_limbs(joint: Floats, parents: Ints, middle: Floats) -> Floats:
    """The mean of the joints by which limbs hang on the root, where the tree goes on in a trunk beside them.

    A limb is a chain without a branch. Where fewer than two limbs hang on the root, or nothing but limbs, its place does not
    follow from them: `middle` is returned.

    joint   : (part, xyz) about which each part turns, mesh unit; the root's own does not count
    parents : (part,) −1 for the root, parents first
    middle  : (xyz) of the root's surface, mesh unit
    returns : (xyz) mesh unit
    """
    below = np.bincount(parents[1:], minlength=len(parents))
    branching = below > 1
    for part in range(len(parents) - 1, 0, -1):
        branching[parents[part]] |= branching[part]
    hanging = np.flatnonzero(parents == 0)
    limbs = hanging[~branching[hanging]]
    if len(limbs) < 2 or len(limbs) == len(hanging):
        return middle
    return np.asarray(joint[limbs].mean(axis=0), np.float64)
