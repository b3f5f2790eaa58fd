"""Laws of rigid residuals from sums."""

import numpy as np
from limbs import rotation

from kinetree.tasks.numerics.geometry.rigid_moments import moments, motion, residual


def cloud(noise=0.0, frames=3):
    rng = np.random.default_rng(1)
    V = rng.normal(size=(60, 3))
    R = np.stack([rotation((1, 2, t), 0.9 * t) for t in range(frames)])
    x = np.einsum("tij,vj->tvi", R, V) + rng.normal(size=(frames, 1, 3)) + noise * rng.normal(size=(frames, 60, 3))
    return V, x, R


def test_what_moves_rigidly_leaves_nothing_and_its_motion_is_found():
    V, x, R = cloud()
    M = moments(V, x, np.ones(x.shape[:2]), np.zeros(60, np.int64), 1)
    for f in range(3):
        found, t = np.empty((3, 3)), np.empty(3)
        motion(M[0, f], found, t)
        assert residual(M[0, f]) < 1e-9
        np.testing.assert_allclose(found, R[f], atol=1e-9)
        np.testing.assert_allclose(V @ found.T + t, x[f], atol=1e-9)


def test_the_residual_is_that_of_the_best_motion_and_no_other_leaves_less():
    V, x, _ = cloud(noise=0.1)
    weight = np.random.default_rng(2).random(x.shape[:2])
    M = moments(V, x, weight, np.zeros(60, np.int64), 1)
    for f in range(3):
        R, t = np.empty((3, 3)), np.empty(3)
        motion(M[0, f], R, t)
        left = (weight[f] * ((V @ R.T + t - x[f]) ** 2).sum(axis=1)).sum()
        np.testing.assert_allclose(residual(M[0, f]), left, rtol=1e-9)
        for axis in np.eye(3):
            other = rotation(tuple(axis), 0.02) @ R
            shift = (weight[f][:, None] * (x[f] - V @ other.T)).sum(axis=0) / weight[f].sum()
            assert (weight[f] * ((V @ other.T + shift - x[f]) ** 2).sum(axis=1)).sum() > left


def test_sums_of_two_sets_are_those_of_their_union():
    V, x, _ = cloud(noise=0.1)
    weight, halves = np.ones(x.shape[:2]), np.arange(60) % 2
    M = moments(V, x, weight, halves, 2)
    np.testing.assert_allclose(M[0] + M[1], moments(V, x, weight, np.zeros(60, np.int64), 1)[0], atol=1e-12)


def test_a_mirror_image_is_no_rigid_motion():
    V, _, _ = cloud()
    M = moments(V, (V * [-1, 1, 1])[None], np.ones((1, 60)), np.zeros(60, np.int64), 1)
    R, t = np.empty((3, 3)), np.empty(3)
    motion(M[0, 0], R, t)
    assert np.linalg.det(R) > 0.99
    assert residual(M[0, 0]) > 1.0


def test_an_empty_set_stays_where_it_is():
    R, t = np.empty((3, 3)), np.empty(3)
    motion(np.zeros(17), R, t)
    np.testing.assert_array_equal(R, np.eye(3))
    assert residual(np.zeros(17)) == 0.0
