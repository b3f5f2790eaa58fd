"""Skin is soft where no joint has most of it; what is far away does not count, nor does the size of the body."""

import numpy as np
import pytest
from shapes import open_cylinder

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.geometry.surface import surface_areas
from kinetree.tasks.numerics.structure.skin_softness import skin_softness

V, F = open_cylinder(40, 60)
"""Radius 1, from z = 0 to 4."""
JOINTS = np.array([(0.0, 0.0, 1.0), (0.0, 0.0, 3.0)])


def weights(width: float) -> Floats:
    """(vertex, 2) of a bend at z = 1 that blends over a width."""
    lower = np.clip(0.5 + (1.0 - V[:, 2]) / width, 0.0, 1.0)
    return np.stack([lower, 1.0 - lower], axis=1)


def softness(width: float, scale: float = 1.0) -> Floats:
    W = weights(width)
    return skin_softness(scale * V, surface_areas(scale * V, F), W, scale * JOINTS)


def test_skin_is_softer_where_it_blends_over_a_wider_range() -> None:
    narrow, wide = softness(0.2), softness(1.6)
    assert 0.0 < narrow[0] < 0.7 * wide[0]
    assert wide[0] < 0.5
    assert narrow[1] < 1e-3


def test_rigid_skin_has_none_and_skin_of_two_joints_alike_half() -> None:
    area, whole = surface_areas(V, F), np.eye(2)[(V[:, 2] > 1.0).astype(int)]
    np.testing.assert_array_equal(skin_softness(V, area, whole, JOINTS), 0.0)
    np.testing.assert_allclose(skin_softness(V, area, np.full((len(V), 4), 0.25), JOINTS), 0.75)
    np.testing.assert_allclose(skin_softness(V, area, np.full((len(V), 2), 0.5), JOINTS), 0.5)


def test_the_same_on_a_body_of_another_size() -> None:
    assert softness(0.8, scale=250.0) == pytest.approx(softness(0.8))


def test_a_joint_far_outside_the_body_has_the_softness_of_the_skin_that_is_nearest() -> None:
    far = np.array([(0.0, 0.0, -500.0)])
    assert skin_softness(V, surface_areas(V, F), weights(0.8), far) == pytest.approx(0.0, abs=1e-6)
