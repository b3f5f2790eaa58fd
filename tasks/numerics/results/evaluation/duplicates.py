"""Spurious joints that stand beside a true joint which is found already, told from those that stand where no joint is."""

from collections.abc import Sequence

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.results.evaluation.matching import mean_distances


def duplicated(X: Floats, Y: Floats, spurious: Ints, candidates: Flags, limit: float) -> Ints:
    """The true joint that each spurious joint is a second one of (ours).

    X          : (frame, joint, xyz) joints of the result, mesh unit
    Y          : (frame, true, xyz) true joints, mesh unit
    spurious   : (k,) joints of the result that are no true joint
    candidates : (true,) true joints that have a partner and are no tips
    limit      : largest mean distance over the frames at which it is a second one, mesh unit
    returns    : (k,) the nearest candidate, −1 where none is within the limit: the joint is false
    """
    if not len(spurious) or not candidates.any():
        return np.full(len(spurious), -1, dtype=np.int64)
    distance = np.where(candidates, mean_distances(X[:, spurious], Y), np.inf)
    nearest = distance.argmin(axis=1)
    within = distance[np.arange(len(spurious)), nearest] <= limit
    return np.where(within, nearest, -1).astype(np.int64)


def branching(parents: Sequence[int]) -> Flags:
    """(true,) joints that several bones hang on; parents : (true,) −1 for the root."""
    above = np.array(parents, dtype=np.int64)
    return np.bincount(above[above >= 0], minlength=len(above)) > 1
