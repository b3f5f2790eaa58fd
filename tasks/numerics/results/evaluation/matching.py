"""Which joint of the result is which true joint, decided once for all frames.

The cost of a pair is its mean distance over the frames. A pair farther apart than the limit costs as much as no pair, so that a
missing joint cannot change the partners of its neighbours (the assignment of OSPA with p = 1: Schuhmacher, Vo, Vo 2008). Every
joint has at most one partner: of two joints found near one true joint, one is its partner and the other is spurious.
"""

from typing import NamedTuple

import numpy as np
from scipy.optimize import linear_sum_assignment

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints


class Matching(NamedTuple):
    """The partner of every true joint, and the joints without one.

    partner  : (true,) the joint of the result that is each true joint, −1 where it is missing
    nearest  : (true,) mean distance to the nearest joint that is allowed as partner, mesh unit; infinite where none is
    spurious : (joint,) joints of the result that are no true joint, ascending
    """

    partner: Ints
    nearest: Floats
    spurious: Ints


def matching(X: Floats, Y: Floats, allowed: Flags, *, scored: Flags, can_be_spurious: Flags, limit: float) -> Matching:
    """Assigns joints of the result first to scored true joints, then the free ones to true joints that are not scored.

    Because of the second assignment, a joint that exists in truth but hardly turns is neither missing nor spurious.

    X               : (frame, joint, xyz) joints of the result, mesh unit
    Y               : (frame, true, xyz) true joints, mesh unit
    allowed         : (joint, true) which pairs are possible; a root cannot be an elbow
    scored          : (true,) joints that the result should have
    can_be_spurious : (joint,) joints of the result that count as spurious without a partner; a root does not
    limit           : largest mean distance of a pair, mesh unit
    """
    cost = np.where(allowed, mean_distances(X, Y), np.inf)
    partner = np.full(Y.shape[1], -1, dtype=np.int64)
    free = np.ones(X.shape[1], dtype=bool)
    for column in (np.flatnonzero(scored), np.flatnonzero(~scored)):
        row = np.flatnonzero(free)
        for i, j in assignment(cost[np.ix_(row, column)], limit):
            partner[column[j]] = row[i]
            free[row[i]] = False
    nearest = cost.min(axis=0) if len(cost) else np.full(Y.shape[1], np.inf)
    return Matching(partner, nearest, np.flatnonzero(free & can_be_spurious))


def mean_distances(X: Floats, Y: Floats) -> Floats:
    """Mean over the frames of the distance |x_i(t) − y_j(t)| of every pair.

    X       : (frame, joint, xyz) mesh unit
    Y       : (frame, true, xyz) mesh unit
    returns : (joint, true) mesh unit
    """
    total = np.zeros((X.shape[1], Y.shape[1]))
    for x, y in zip(X, Y, strict=True):
        total += np.linalg.norm(x[:, None] - y[None], axis=2)
    return total / max(len(X), 1)


def assignment(cost: Floats, limit: float) -> list[tuple[int, int]]:
    """Pairs of rows and columns that minimise Σ min(cost, limit), without the pairs above the limit.

    cost    : (row, column) infinite where a pair is impossible
    limit   : in the unit of the cost
    returns : (row, column) of every pair
    """
    rows, columns = linear_sum_assignment(np.minimum(cost, limit))
    return [(int(i), int(j)) for i, j in zip(rows, columns, strict=True) if cost[i, j] <= limit]


def joint_errors(X: Floats, Y: Floats, partner: Ints) -> Floats:
    """Distance of every true joint from its partner in every frame.

    X       : (frame, joint, xyz) mesh unit
    Y       : (frame, true, xyz) mesh unit
    partner : (true,) as in `Matching`
    returns : (frame, true) mesh unit; NaN where there is no partner
    """
    distance = np.linalg.norm(X[:, np.maximum(partner, 0)] - Y, axis=2)
    return np.where(partner >= 0, distance, np.nan)
