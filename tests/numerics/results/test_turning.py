"""Laws of turning: the angle of a hinge with its sign, and none where a joint turns about several axes."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from kinetree.tasks.numerics.results.turning import signed_turning, turning

FRONT = np.array([0.0, 0.0, 1.0])
DOWN = np.array([[0.0, -1.0, 0.0]])
ANGLE = np.radians(np.linspace(-30, 60, 10))


def about(axis: tuple[float, float, float]) -> np.ndarray:
    return (ANGLE[:, None] * np.array(axis))[:, None]


def test_turning_against_a_parent_does_not_know_how_the_parent_moves() -> None:
    parent, own = Rotation.random(10, rng=np.random.default_rng(0)), Rotation.from_rotvec(about((1, 0, 0))[:, 0])
    R = np.stack([parent.as_matrix(), (parent * own).as_matrix()], axis=1)
    w = turning(R, (-1, 0))
    np.testing.assert_allclose(w[:, 0], 0.0, atol=1e-7)
    np.testing.assert_allclose(w[:, 1], own.as_rotvec(), atol=1e-7)


def test_far_end_that_swings_forwards_counts_positive_whichever_way_the_axis_is_written() -> None:
    """A bone that hangs down swings forwards about −x."""
    for axis, sign in (((-1.0, 0.0, 0.0), 1.0), ((1.0, 0.0, 0.0), -1.0)):
        np.testing.assert_allclose(signed_turning(about(axis), DOWN, FRONT)[:, 0], sign * ANGLE, atol=1e-12)


@pytest.mark.parametrize("axis", [(0.0, 0.0, 1.0), (0.0, 1.0, 0.0)], ids=["sideways", "about the bone"])
def test_turning_neither_forwards_nor_backwards_has_no_sign(axis: tuple[float, float, float]) -> None:
    assert np.isnan(signed_turning(about(axis), DOWN, FRONT)).all()


def test_joint_of_several_axes_and_body_without_a_front_have_no_sign() -> None:
    both = about((1.0, 0.0, 0.0)) + np.roll(about((0.0, 0.0, 1.0)), 5, axis=0)
    assert np.isnan(signed_turning(both, DOWN, FRONT)).all()
    assert np.isnan(signed_turning(about((1.0, 0.0, 0.0)), DOWN, np.zeros(3))).all()
    assert np.isnan(signed_turning(about((1.0, 0.0, 0.0)), 0 * DOWN, FRONT)).all()
