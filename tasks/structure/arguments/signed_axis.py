"""Directions of the coordinates as vectors."""

import numpy as np

from kinetree.tasks.numerics.arrays import Floats


def signed_axis(axis: str) -> Floats:
    """(xyz,) the unit vector of x, y or z, or with a minus before it the opposite one."""
    vector = np.zeros(3)
    vector["xyz".index(axis[-1])] = -1.0 if axis.startswith("-") else 1.0
    return vector
