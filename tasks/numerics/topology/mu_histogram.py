"""The distribution of μ over one frame, kept so finely that frames can be compared without their vertices (2014, Sec. 4)."""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats

FINE_BINS = 2000
"""Bins of one frame's summary: twenty to each of the hundred in which frames are compared."""


class Summary(NamedTuple):
    """Distribution of x on one frame.

    low, high : range of x
    mass      : (fine,) share of the weight in each of the even bins from low to high; all in the first if low = high
    """

    low: float
    high: float
    mass: Floats


def dimensionless(mu: Floats, area: Floats) -> Floats:
    """Mean distance x = μ / A^{3/2} from a vertex to the surface in units of √A: no unit, the same at any scale.

    mu      : (vertex,) ∫ g dA, mesh unit³
    area    : (vertex,) mesh unit², summing to A
    returns : (vertex,); 0.443 everywhere on a sphere
    """
    return mu / float(area.sum()) ** 1.5


def summary(x: Floats, weight: Floats | None = None, fine: int = FINE_BINS) -> Summary:
    """The distribution of x on one frame, all that a comparison of frames needs of it.

    x      : (vertex,) finite, at least one
    weight : (vertex,) at least 0, not all 0; None counts every vertex once (the paper)
    fine   : bins; a multiple of the bins it will be read in keeps "frame" histograms exact
    """
    low, high = float(x.min()), float(x.max())
    if not high > low:
        return Summary(low, high, np.eye(1, fine)[0])
    bin_of = np.minimum(((x - low) * (fine / (high - low))).astype(np.int64), fine - 1)
    mass = np.bincount(bin_of, weight, fine).astype(np.float64)
    return Summary(low, high, mass / mass.sum())
