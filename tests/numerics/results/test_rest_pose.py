"""Laws of rest poses."""

import numpy as np
import pytest

from kinetree.tasks.numerics.results.rest_pose import least_rotation, rest_pose, standing_targets

RNG = np.random.default_rng(5)
UP, FRONT = np.array([0.0, 0.0, 1.0]), np.array([0.0, -1.0, 0.0])


def unit(v):
    return v / np.linalg.norm(v)


def test_least_rotation_brings_one_direction_to_the_other_by_the_angle_between_them():
    for a, b in [(unit(RNG.normal(size=3)), unit(RNG.normal(size=3))) for _ in range(20)] + [(UP, UP), (UP, -UP)]:
        R = least_rotation(a, b)
        np.testing.assert_allclose(R @ a, b, atol=1e-12)
        np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-12)
        assert np.linalg.det(R) == pytest.approx(1.0)
        assert np.trace(R) == pytest.approx(1.0 + 2.0 * a @ b)


def test_bones_have_their_directions_and_keep_their_lengths():
    rest, parents, ahead = RNG.normal(size=(5, 3)), (-1, 0, 1, 2, 1), (1, 2, 3, 3, 4)
    target = np.full((5, 3), np.nan)
    target[1], target[2] = UP, FRONT
    root = least_rotation(UP, FRONT)
    pose = rest_pose(rest, parents, ahead, root, target)
    np.testing.assert_allclose(unit(pose.X[2] - pose.X[1]), UP, atol=1e-12)
    np.testing.assert_allclose(unit(pose.X[3] - pose.X[2]), FRONT, atol=1e-12)
    np.testing.assert_allclose(pose.X[1] - pose.X[0], root @ (rest[1] - rest[0]), atol=1e-12)
    for j, p in enumerate(parents[1:], start=1):
        np.testing.assert_allclose(np.linalg.norm(pose.X[j] - pose.X[p]), np.linalg.norm(rest[j] - rest[p]))


def test_a_person_stands_with_the_arms_to_the_sides():
    target = standing_targets(("pelvis", "knee_l", "elbow_l", "shoulder_r", "ankle_r", "head", ""), UP, FRONT, 0.0)
    np.testing.assert_allclose(target[1:6], [-UP, [1, 0, 0], [-1, 0, 0], FRONT, UP], atol=1e-12)
    assert np.isnan(target[[0, 6]]).all()
    half = np.sqrt(0.5)
    np.testing.assert_allclose(standing_targets(("wrist_l",), UP, FRONT, 45.0)[0], [half, 0, -half], atol=1e-12)
