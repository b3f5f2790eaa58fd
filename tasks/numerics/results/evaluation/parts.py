"""How well one division of the surface into parts agrees with another."""

import numpy as np
import numpy.typing as npt
from scipy.optimize import linear_sum_assignment

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Indices = npt.NDArray[np.integer]


def leading_parts(label: Indices, influence: Indices, weight: Floats) -> Ints:
    """(vertex,) the part that a vertex is labelled with, or where it has no label the one that it follows most.

    label             : (vertex,) −1 where there is none
    influence, weight : (vertex, k) parts that a vertex follows, and how much
    """
    most = influence[np.arange(len(label)), weight.argmax(axis=1)]
    return np.where(label >= 0, label, most).astype(np.int64)


def contingency(label: Ints, other: Ints) -> Ints:
    """(part, other part) how many points have each pair of labels.

    label, other : (point,) any whole numbers, the same for all points of a part
    """
    rows, i = np.unique(label, return_inverse=True)
    columns, j = np.unique(other, return_inverse=True)
    table = np.zeros((len(rows), len(columns)), dtype=np.int64)
    np.add.at(table, (i.ravel(), j.ravel()), 1)
    return table


def rand_index(table: Ints) -> float:
    """Share of the pairs of points on which both divisions agree, together or apart (Rand 1971).

    table : (part, other part) counts; at least two points
    """
    both, one, two, every = _pairs(table)
    return 1.0 - (one + two - 2.0 * both) / every


def adjusted_rand_index(table: Ints) -> float:
    """The Rand index, 0 where chance would have it and 1 where the divisions are the same (Hubert, Arabie 1985).

    table : (part, other part) counts; at least two points
    """
    both, one, two, every = _pairs(table)
    chance = one * two / every
    most = (one + two) / 2.0
    return 1.0 if most == chance else (both - chance) / (most - chance)


def mean_iou(table: Ints) -> float:
    """Intersection over union of each part of the second division with its partner in the first, averaged.

    Partners are the assignment with the largest sum; a part without a partner counts 0.

    table : (part, true part) counts
    """
    union = table.sum(axis=1)[:, None] + table.sum(axis=0)[None] - table
    iou = table / np.maximum(union, 1)
    rows, columns = linear_sum_assignment(-iou)
    return float(iou[rows, columns].sum() / table.shape[1])


def _pairs(table: Ints) -> tuple[float, float, float, float]:
    """Pairs of points together in both divisions, in the first, in the second, and all."""
    return _two(table), _two(table.sum(axis=1)), _two(table.sum(axis=0)), _two(table.sum())


def _two(count: "Ints | np.int64") -> float:
    n = np.asarray(count, dtype=np.float64)
    return float((n * (n - 1.0) / 2.0).sum())
