"""Laws of derivatives by local polynomials."""

import numpy as np
import pytest
from scipy.signal import savgol_filter

from kinetree.tasks.numerics.results.derivatives import derivatives


@pytest.mark.parametrize("degree", [2, 3])
def test_even_spacing_gives_the_filter_of_savitzky_and_golay(degree):
    X = np.random.default_rng(1).normal(size=(40, 2, 3))
    motion = derivatives(X, np.arange(40) / 25, 0.28, degree)
    assert motion.samples == 7
    for order, values in ((1, motion.velocity), (2, motion.acceleration)):
        np.testing.assert_allclose(values, savgol_filter(X, 7, degree, deriv=order, delta=1 / 25, axis=0), atol=1e-6)


def test_polynomial_is_differentiated_exactly_also_where_samples_are_missing():
    t = np.array([0, 1, 2, 3, 7, 8, 9, 10, 11, 15, 16]) / 10
    motion = derivatives(np.stack([t**3, 5 - 2 * t], axis=1), t, 0.5, 3)
    np.testing.assert_allclose(motion.velocity, np.stack([3 * t**2, -2 + 0 * t], axis=1), atol=1e-9)
    np.testing.assert_allclose(motion.acceleration, np.stack([6 * t, 0 * t], axis=1), atol=1e-7)


def test_longer_window_leaves_less_noise():
    X = np.random.default_rng(2).normal(size=(200, 1))
    narrow, wide = (derivatives(X, np.arange(200) / 25, window, 3).velocity.std() for window in (0.2, 0.8))
    assert wide < narrow / 3


def test_few_samples_are_fitted_as_far_as_they_go():
    X = np.array([[0.0], [2.0]])
    motion = derivatives(X, np.array([0.0, 0.5]), 0.3, 3)
    np.testing.assert_allclose(motion.velocity, 4.0)
    np.testing.assert_array_equal(motion.acceleration, 0.0)
    np.testing.assert_array_equal(derivatives(X[:1], np.zeros(1), 0.3, 3).velocity, 0.0)
