"""Laws of the blocks of a fit."""

import numpy as np

from kinetree.tasks.numerics.registration.block_system import block_inverses


def test_inverses_of_blocks_are_inverses_whatever_stands_above_the_diagonal():
    A = np.random.default_rng(1).normal(size=(50, 6, 6)) * [1e-3, 1e-3, 1e-3, 1.0, 1.0, 1.0]
    D = A @ A.transpose(0, 2, 1) + 1e-6 * np.eye(6)
    inverse = block_inverses(np.tril(D))
    np.testing.assert_array_equal(inverse, inverse.transpose(0, 2, 1))
    np.testing.assert_allclose(inverse @ D, np.tile(np.eye(6), (50, 1, 1)), atol=1e-6)
