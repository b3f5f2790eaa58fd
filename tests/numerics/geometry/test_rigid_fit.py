"""Laws of rigid fits, from points, from their sums and of single matrices; against singular values."""

import numpy as np
import pytest
from limbs import rotation

from kinetree.tasks.numerics.geometry.rigid_fit import (
    moments,
    motion,
    nearest_rotation,
    nearest_rotations,
    residual,
    rigid_motion,
    rotation_gain,
    turn_all,
    turn_towards,
)

RNG = np.random.default_rng(5)
PLAIN = RNG.normal(size=(500, 3, 3))
KINDS = {
    "any": PLAIN,
    "flat": PLAIN * np.array([1.0, 1.0, 0.0]),
    "nearly a line": PLAIN * np.array([1.0, 1e-3, 1e-5]),
    "small": PLAIN * 1e-12,
    "rotations": np.linalg.qr(PLAIN)[0] * np.linalg.det(np.linalg.qr(PLAIN)[0])[:, None, None],
}


def by_singular_values(H):
    """(matrix, 3, 3) rotations of largest tr(Rᵀ H), and that trace (Kabsch)."""
    U, s, Vt = np.linalg.svd(H)
    sign = np.sign(np.linalg.det(U @ Vt))
    s[:, 2] *= sign
    U[:, :, 2] *= sign[:, None]
    return U @ Vt, s.sum(axis=1)


@pytest.mark.parametrize("kind", KINDS)
def test_rotation_is_that_of_the_singular_value_decomposition(kind):
    H, R = KINDS[kind], np.tile(np.eye(3), (500, 1, 1))
    trace = turn_all(H, R)
    expected, largest = by_singular_values(H)
    np.testing.assert_allclose(R, expected, atol=1e-9)
    np.testing.assert_allclose(trace, largest, rtol=1e-12)
    np.testing.assert_allclose(np.linalg.det(R), 1.0, atol=1e-12)


def test_a_matrix_of_nought_and_one_of_rank_one_leave_the_rotation_as_it_is():
    turned = by_singular_values(PLAIN[:1])[0][0]
    R = turned.copy()
    assert turn_towards(np.zeros((3, 3)), R) == 0.0
    np.testing.assert_array_equal(R, turned)
    turn_towards(np.outer([1.0, 2.0, 3.0], [0.0, 0.0, 1.0]), R)
    np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-12)


def test_trace_never_falls():
    start = by_singular_values(RNG.normal(size=(500, 3, 3)))[0]
    R = start.copy()
    for H in (PLAIN, PLAIN * 1e-9, PLAIN[::-1].copy(), -np.tile(np.eye(3), (500, 1, 1))):
        before = np.einsum("vab,vab->v", R, H)
        rounding = 1e-14 * np.abs(H).sum(axis=(1, 2))
        assert (turn_all(H, R) >= before - rounding).all()


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
        rotation, t = np.empty((3, 3)), np.empty(3)
        motion(M[0, f], rotation, t)
        assert residual(M[0, f]) < 1e-9
        np.testing.assert_allclose(rotation, R[f], atol=1e-9)
        np.testing.assert_allclose(V @ rotation.T + t, x[f], atol=1e-9)


def test_the_residual_is_that_of_the_best_motion_and_no_other_leaves_less():
    V, x, _ = cloud(noise=0.1)
    weight = np.random.default_rng(2).random(x.shape[:2])
    M = moments(V, x, weight, np.zeros(60, np.int64), 1)
    for f in range(3):
        R, t = np.empty((3, 3)), np.empty(3)
        motion(M[0, f], R, t)
        squared = (weight[f] * ((V @ R.T + t - x[f]) ** 2).sum(axis=1)).sum()
        np.testing.assert_allclose(residual(M[0, f]), squared, rtol=1e-9)
        for axis in np.eye(3):
            other = rotation(tuple(axis), 0.02) @ R
            shift = (weight[f][:, None] * (x[f] - V @ other.T)).sum(axis=0) / weight[f].sum()
            assert (weight[f] * ((V @ other.T + shift - x[f]) ** 2).sum(axis=1)).sum() > squared


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


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_gain_of_a_matrix_is_its_signed_singular_values(sign):
    rng = np.random.default_rng(0)
    for _ in range(50):
        H = rng.standard_normal((3, 3))
        H *= sign * np.sign(np.linalg.det(H))
        s = np.linalg.svd(H)[1]
        assert rotation_gain(H) == pytest.approx(s[0] + s[1] + sign * s[2], rel=1e-7)
    assert rotation_gain(np.zeros((3, 3))) == 0.0


def test_the_nearest_rotation_gains_the_most_whatever_the_number_of_matrices():
    for kind in ("any", "flat", "rotations"):
        R = nearest_rotation(KINDS[kind].reshape(5, 100, 3, 3))
        np.testing.assert_allclose(np.linalg.det(R), 1.0, atol=1e-12)
        gain = np.einsum("abij,abij->ab", R, KINDS[kind].reshape(5, 100, 3, 3)).ravel()
        np.testing.assert_allclose(gain, [rotation_gain(H) for H in KINDS[kind]], rtol=1e-7)


@pytest.mark.parametrize("kind", ["any", "flat", "small", "rotations"])
def test_nearest_rotations_of_many_matrices_are_those_of_each_one(kind):
    np.testing.assert_allclose(nearest_rotations(KINDS[kind]), nearest_rotation(KINDS[kind]), atol=1e-11)


def test_motion_from_points_is_that_from_their_sums():
    V, x, _ = cloud(noise=0.1)
    weight = np.random.default_rng(2).random(x.shape[:2])
    R, t = rigid_motion(np.broadcast_to(V, x.shape), x, weight)
    assert R.shape == (3, 3, 3)
    M = moments(V, x, weight, np.zeros(60, np.int64), 1)
    for f in range(3):
        turned, shifted = np.empty((3, 3)), np.empty(3)
        motion(M[0, f], turned, shifted)
        np.testing.assert_allclose(R[f], turned, atol=1e-9)
        np.testing.assert_allclose(t[f], shifted, atol=1e-9)


def test_without_weights_all_points_count_alike():
    V, x, _ = cloud(noise=0.1)
    for one, other in zip(rigid_motion(V, x[1]), rigid_motion(V, x[1], np.full(60, 7.0)), strict=True):
        np.testing.assert_allclose(one, other, atol=1e-12)


def test_points_on_a_line_are_laid_on_the_line():
    V = np.linspace(-1, 1, 9)[:, None] * np.array([1.0, 2.0, -1.0])
    x = V @ rotation((1, 0, 2), 2.0).T + 3.0
    R, t = rigid_motion(V, x)
    np.testing.assert_allclose(V @ R.T + t, x, atol=1e-9)
    motion(moments(V, x[None], np.ones((1, 9)), np.zeros(9, np.int64), 1)[0, 0], R, t)
    np.testing.assert_allclose(V @ R.T + t, x, atol=1e-9)
