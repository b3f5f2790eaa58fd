"""Small matrices agree with SciPy's and NumPy's."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from kinetree.tasks.numerics.geometry.small_matrices import product, rotation, solved

RNG = np.random.default_rng(0)
A, B = RNG.normal(size=(2, 3, 3))


@pytest.mark.parametrize("w", [(0.0, 0.0, 0.0), (1e-9, 0.0, 0.0), (0.1, -0.2, 0.3), (2.0, 1.0, -1.0)])
def test_rotation_by_a_vector_is_scipys(w: tuple[float, ...]) -> None:
    np.testing.assert_allclose(rotation(np.array(w), 9.0), Rotation.from_rotvec(w).as_matrix(), atol=1e-14)


def test_a_longer_turn_goes_about_the_same_axis_as_far_as_it_may() -> None:
    w = np.array([2.0, 1.0, -1.0])
    np.testing.assert_allclose(rotation(w, 0.4), Rotation.from_rotvec(0.4 * w / np.linalg.norm(w)).as_matrix(), atol=1e-14)


def test_product_is_that_of_the_matrices() -> None:
    np.testing.assert_allclose(product(A, B), A @ B, atol=1e-14)
    np.testing.assert_allclose(product(A.T, B), A.T @ B, atol=1e-14)


@pytest.mark.parametrize("free", [1, 6, 9])
def test_equations_are_solved_for_the_unknowns_that_are_free(free: int) -> None:
    J, g = RNG.normal(size=(20, 9)), RNG.normal(size=9)
    H = J.T @ J
    z = solved(np.triu(H), g, free)  # below the diagonal nothing is read
    np.testing.assert_allclose(z[:free], np.linalg.solve(H[:free, :free], g[:free]), rtol=1e-9)
    assert not z[free:].any()
