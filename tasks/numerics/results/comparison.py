"""Which joint of one skeleton is which joint of another, where neither of them is the truth."""

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats
from kinetree.tasks.numerics.results.evaluation.matching import mean_distances

BOX_TOLERANCE = 0.1
"""Largest distance between equal corners of two bounding boxes of one body in one frame, share of the larger diagonal: a body
carved from silhouettes has to fit its mesh. Not chosen on data."""


def allowed_distances(X: Floats, Y: Floats, allowed: Flags) -> Floats:
    """Mean distance over the frames of every pair that is allowed.

    X       : (frame, joint of the first, xyz) mesh unit
    Y       : (frame, joint of the second, xyz) mesh unit
    allowed : (joint of the first, joint of the second)
    returns : the same shape, mesh unit; infinite where a pair is not allowed
    """
    return np.where(allowed, mean_distances(X, Y), np.inf)


def mutual_nearest(distance: Floats, limit: float) -> list[tuple[int, int]]:
    """Pairs of which each is the nearest to the other, and which are not farther apart than the limit (ours).

    No joint is in two pairs, and the pairs are the same whichever skeleton is the first. Of equal distances the first counts.

    distance : (joint of the first, joint of the second) mesh unit, infinite where a pair is not allowed
    limit    : mesh unit
    returns  : (joint of the first, joint of the second) of every pair, ascending
    """
    if not distance.size:
        return []
    nearest, back = distance.argmin(axis=1), distance.argmin(axis=0)
    return [(i, int(j)) for i, j in enumerate(nearest) if back[j] == i and distance[i, j] <= limit]


def pair_distances(X: Floats, Y: Floats, pairs: list[tuple[int, int]]) -> Floats:
    """(frame, pair) distance of the two joints of every pair, mesh unit; X, Y as in `allowed_distances`."""
    first, second = np.array(pairs, dtype=np.int64).reshape(-1, 2).T
    return np.asarray(np.linalg.norm(X[:, first] - Y[:, second], axis=2))


def box_difference(V: Floats, W: Floats) -> float:
    """How far two bodies' bounding boxes are apart: largest distance of equal corners, share of the larger diagonal.

    V, W : (vertex, xyz) mesh unit
    """
    boxes = np.array([[V.min(axis=0), V.max(axis=0)], [W.min(axis=0), W.max(axis=0)]])
    diagonal = np.linalg.norm(boxes[:, 1] - boxes[:, 0], axis=1).max()
    return float(np.linalg.norm(boxes[0] - boxes[1], axis=1).max() / max(diagonal, 1e-300))
