"""Colours whose every point's is known: waves over space, on tubes and in files."""

import numpy as np

from kinetree.tasks.numerics.arrays import Floats


def waves(V: Floats) -> Floats:
    """(vertex, rgb) smooth colours of points of a tube, other ones on either side of it."""
    x, y, z = V.T
    return np.stack([0.5 + 0.3 * np.sin(1.5 * x), 0.5 + 0.3 * np.sin(1.5 * y + 0.6), 0.5 + 0.3 * np.sin(1.1 * z)], axis=1)
