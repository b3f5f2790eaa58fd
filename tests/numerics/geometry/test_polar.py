"""Laws of the rotation nearest to a matrix, against singular values."""

import numpy as np
import pytest

from kinetree.tasks.numerics.geometry.polar import turn_all, turn_towards

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
