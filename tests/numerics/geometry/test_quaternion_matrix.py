"""Laws of the quaternion matrix, against another eigenvalue solver."""

import numpy as np
import pytest
from limbs import rotation

from kinetree.tasks.numerics.geometry.quaternion_matrix import (
    adjugate_eigenvector,
    jacobi_eigenvector,
    largest_root,
    quaternion_matrix,
    write_rotation,
)

MATRICES = np.random.default_rng(5).normal(size=(200, 3, 3))


def test_its_form_of_a_quaternion_is_the_trace_with_the_rotation():
    R = np.empty((3, 3))
    for H, q in zip(MATRICES, np.random.default_rng(6).normal(size=(200, 4)), strict=True):
        q /= np.linalg.norm(q)
        write_rotation(q, R)
        np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-12)
        assert q @ quaternion_matrix(H) @ q == pytest.approx((R * H).sum(), abs=1e-12)


def test_a_quaternion_turns_about_its_axis_by_twice_its_angle():
    R = np.empty((3, 3))
    axis = np.array([1.0, 2.0, -2.0]) / 3.0
    write_rotation(np.append(np.cos(0.4), np.sin(0.4) * axis), R)
    np.testing.assert_allclose(R, rotation((1.0, 2.0, -2.0), 0.8), atol=1e-12)


def test_largest_root_and_both_eigenvectors_are_those_of_another_solver():
    q = np.empty(4)
    for H in MATRICES:
        values, vectors = np.linalg.eigh(quaternion_matrix(H))
        for bound in (np.sqrt(3.0) * np.linalg.norm(H), values[-1] * 1.001):
            assert largest_root(H, bound) == pytest.approx(values[-1], rel=1e-9)
        assert adjugate_eigenvector(quaternion_matrix(H), values[-1], q)
        assert abs(q @ vectors[:, -1]) == pytest.approx(1.0, abs=1e-9)
        assert abs(jacobi_eigenvector(quaternion_matrix(H)) @ vectors[:, -1]) == pytest.approx(1.0, abs=1e-9)


def test_where_all_eigenvalues_meet_the_adjugate_knows_no_direction_and_jacobi_gives_one():
    assert not adjugate_eigenvector(np.eye(4), 1.0, np.empty(4))
    assert np.linalg.norm(jacobi_eigenvector(np.eye(4))) == 1.0
