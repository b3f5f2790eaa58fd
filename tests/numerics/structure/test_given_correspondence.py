"""When an alignment is certain, and when the frames give it."""

import numpy as np

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.structure.given_correspondence import is_given, limited_confidence

ONE: Floats = np.ones((2, 3))


def test_confidence_of_one_everywhere_limits_nothing() -> None:
    less = ONE.copy()
    less[1, 2] = 1.0 - 1e-12
    assert limited_confidence(ONE) is None
    np.testing.assert_array_equal(limited_confidence(less), less)


def test_vertices_that_are_off_their_surface_or_not_certain_are_not_given() -> None:
    off = np.zeros((2, 3))
    off[0, 1] = 1e-12
    assert is_given(ONE, np.zeros((2, 3)))
    assert not is_given(ONE, off)
    assert not is_given(0.5 * ONE, np.zeros((2, 3)))
