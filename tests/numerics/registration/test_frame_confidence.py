"""Laws of what an alignment knows about itself."""

import numpy as np
from limbs import tube
from shapes import sphere

from kinetree.tasks.numerics.registration.frame_confidence import inliers, residuals, stretches


def test_points_of_the_surface_have_no_residual_and_those_beside_it_their_distance():
    V, F = tube()
    assert residuals(V[F].mean(axis=1), V, F).max() < 1e-12
    V, F = sphere(5)
    np.testing.assert_allclose(residuals(1.3 * V, V, F), 0.3, atol=1e-3)


def test_rigid_motion_stretches_nothing_and_scale_everything_by_itself():
    V, F = tube()
    np.testing.assert_allclose(stretches(V, V @ np.diag([-1.0, -1.0, 1.0]) + 5.0, F), 1.0, atol=1e-12)
    np.testing.assert_allclose(stretches(V, 1.5 * V, F), 1.5, atol=1e-12)


def test_only_the_pulled_half_is_stretched():
    V, F = tube(along=60)
    x = np.where(V[:, 2:] > 0, V * [1, 1, 2], V)
    s = stretches(V, x, F)
    assert s[V[:, 2] > 1].mean() > 1.2
    np.testing.assert_allclose(s[V[:, 2] < -1], 1.0, atol=1e-12)


def test_a_vertex_without_edges_or_with_edges_of_no_length_is_not_stretched():
    V, F = np.zeros((4, 3)), np.array([[0, 1, 2]])
    np.testing.assert_array_equal(stretches(V, V + 1.0, F), 1.0)


def test_a_frame_far_from_the_surface_or_half_uncovered_is_an_outlier():
    uncovered, residual = np.full(9, 0.001), np.full(9, 0.1)
    assert inliers(uncovered, residual).all()
    uncovered[3], residual[5] = 0.2, 0.5
    np.testing.assert_array_equal(np.flatnonzero(~inliers(uncovered, residual)), [3, 5])


def test_a_sequence_that_lacks_a_limb_throughout_has_no_inliers():
    assert not inliers(np.full(5, 0.2), np.full(5, 0.1)).any()
