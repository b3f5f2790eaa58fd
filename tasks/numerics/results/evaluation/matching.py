"""Which found joint is which true one, over all frames at once.

A pair costs its mean distance over the frames; a pair farther than the limit costs as much as no pair, so that a joint that
was missed cannot push its neighbours' partners around (the assignment of OSPA, Schuhmacher, Vo, Vo 2008, with p = 1).
Every joint has one partner at most: two joints found beside one true joint are one found and one spurious.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.optimize import linear_sum_assignment

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Bools = npt.NDArray[np.bool_]


class Matching(NamedTuple):
    """What was found of the true joints.

    partner  : (true,) the found joint that is each true joint, −1 where there is none
    nearest  : (true,) mean distance to the nearest found joint that may be it, mesh unit; infinite where none may
    spurious : (joint,) found joints that are no true joint, ascending
    """

    partner: Ints
    nearest: Floats
    spurious: Ints


def matching(X: Floats, Y: Floats, may: Bools, *, scored: Bools, may_be_spurious: Bools, limit: float) -> Matching:
    """Assigns found joints to scored true ones, then those that are left to true joints that are not scored.

    The second assignment is what makes a joint that truly exists but hardly turns neither missing nor spurious.

    X               : (frame, joint, xyz) found, mesh unit
    Y               : (frame, true, xyz) true, mesh unit
    may             : (joint, true) which pairs there can be; a root is no elbow
    scored          : (true,) joints that should be found
    may_be_spurious : (joint,) found joints that claim something; a root has to be somewhere
    limit           : mean distance at which a pair is none, mesh unit
    """
    cost = np.where(may, mean_distances(X, Y), np.inf)
    partner = np.full(Y.shape[1], -1, dtype=np.int64)
    free = np.ones(X.shape[1], dtype=bool)
    for column in (np.flatnonzero(scored), np.flatnonzero(~scored)):
        row = np.flatnonzero(free)
        for i, j in assigned(cost[np.ix_(row, column)], limit):
            partner[column[j]] = row[i]
            free[row[i]] = False
    nearest = cost.min(axis=0) if len(cost) else np.full(Y.shape[1], np.inf)
    return Matching(partner, nearest, np.flatnonzero(free & may_be_spurious))


def mean_distances(X: Floats, Y: Floats) -> Floats:
    """(joint, true) mean over the frames of |x_i(t) − y_j(t)|, mesh unit."""
    total = np.zeros((X.shape[1], Y.shape[1]))
    for x, y in zip(X, Y, strict=True):
        total += np.linalg.norm(x[:, None] - y[None], axis=2)
    return total / max(len(X), 1)


def assigned(cost: Floats, limit: float) -> list[tuple[int, int]]:
    """Pairs of rows and columns that minimise Σ min(cost, limit), those above the limit left out."""
    rows, columns = linear_sum_assignment(np.minimum(cost, limit))
    return [(int(i), int(j)) for i, j in zip(rows, columns, strict=True) if cost[i, j] <= limit]


def errors(X: Floats, Y: Floats, partner: Ints) -> Floats:
    """(frame, true) distance of every true joint from its partner, mesh unit; NaN where it has none."""
    apart = np.linalg.norm(X[:, np.maximum(partner, 0)] - Y, axis=2)
    return np.where(partner >= 0, apart, np.nan)
