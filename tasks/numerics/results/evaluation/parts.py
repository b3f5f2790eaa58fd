"""How well one division of the surface into parts agrees with another."""

import numpy as np
import numpy.typing as npt
from scipy.optimize import linear_sum_assignment

from kinetree.tasks.numerics.arrays import Floats, Ints

Numbers = npt.NDArray[np.integer]
"""Labels and indices, of any integer type."""


def leading_parts(label: Numbers, influence: Numbers, weight: Floats) -> Ints:
    """The part of every vertex: its label, or where it has none the part that it follows most.

    label     : (vertex,) part, −1 where there is none
    influence : (vertex, slot) parts that a vertex follows
    weight    : (vertex, slot) how much it follows each
    returns   : (vertex,) part
    """
    most = influence[np.arange(len(label)), weight.argmax(axis=1)]
    return np.where(label >= 0, label, most).astype(np.int64)


def contingency(label: Ints, other: Ints, count: Ints | None = None) -> Ints:
    """Number of points with each pair of labels.

    label, other : (point,) label in either division, any whole numbers
    count        : (point,) how many points each stands for; None takes each as one
    returns      : (part, other part) counts, parts in ascending order of their labels
    """
    rows, i = np.unique(label, return_inverse=True)
    columns, j = np.unique(other, return_inverse=True)
    table = np.zeros((len(rows), len(columns)), dtype=np.int64)
    np.add.at(table, (i.ravel(), j.ravel()), 1 if count is None else count)
    return table


def rand_index(table: Ints) -> float:
    """Share of the pairs of points on which both divisions agree: in one part in both, or in two parts in both (Rand 1971).

    table   : (part, other part) counts as `contingency` gives them; at least two points
    returns : 0 to 1
    """
    both, one, two, every = _pairs(table)
    return 1.0 - (one + two - 2.0 * both) / every


def adjusted_rand_index(table: Ints) -> float:
    """The Rand index corrected for chance: 0 expected of random labels, 1 for equal divisions (Hubert, Arabie 1985).

    table   : (part, other part) counts as `contingency` gives them; at least two points
    returns : at most 1
    """
    both, one, two, every = _pairs(table)
    chance = one * two / every
    most = (one + two) / 2.0
    return 1.0 if most == chance else (both - chance) / (most - chance)


def mean_iou(table: Ints) -> float:
    """Intersection over union of each part of the second division with its partner in the first, averaged.

    Partners are the one-to-one assignment with the largest sum; a part without a partner counts as 0.

    table   : (part, true part) counts as `contingency` gives them
    returns : 0 to 1
    """
    union = table.sum(axis=1)[:, None] + table.sum(axis=0)[None] - table
    iou = table / np.maximum(union, 1)
    rows, columns = linear_sum_assignment(-iou)
    return float(iou[rows, columns].sum() / table.shape[1])


def _pairs(table: Ints) -> tuple[float, float, float, float]:
    """Number of pairs of points in one part of both divisions, of the first, of the second, and of all pairs."""
    return _pair_count(table), _pair_count(table.sum(axis=1)), _pair_count(table.sum(axis=0)), _pair_count(table.sum())


def _pair_count(count: "Ints | np.int64") -> float:
    """Number of pairs among so many points, summed over the counts."""
    n = np.asarray(count, dtype=np.float64)
    return float((n * (n - 1.0) / 2.0).sum())
