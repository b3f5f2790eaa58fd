"""Laws of the turn of a segment about its length: a known turn comes back, from a bend, a direction or a part beyond."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from kinetree.tasks.numerics.results.axial_rotation import filled, turn_of_bend, turn_of_direction, turn_of_part, turned

FRAMES = 40


@pytest.fixture
def lost():
    """(frame, 3, 3) axes as the surface shows them, (frame,) the turn it lost, and the true axes."""
    rng = np.random.default_rng(5)
    axes = Rotation.random(FRAMES, random_state=2).as_matrix()
    turn = rng.uniform(-1.4, 1.4, FRAMES)
    return axes, turn, turned(axes, turn)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_plane_of_a_bend_shows_the_turn(lost, sign):
    axes, turn, true = lost
    bend = np.radians(np.linspace(30, 150, FRAMES))[:, None]
    forearm = -np.cos(bend) * true[:, :, 1] + sign * np.sin(bend) * true[:, :, 0]
    axial = turn_of_bend(axes, 3.7 * forearm, sign)
    np.testing.assert_allclose(axial.turn, turn, atol=1e-9)
    assert axial.is_seen.all()


def test_direction_beyond_shows_the_turn_unless_it_goes_on_straight(lost):
    axes, turn, true = lost
    ahead = true[:, :, 0] - 0.4 * true[:, :, 1]
    np.testing.assert_allclose(turn_of_direction(axes, 2.0 * ahead).turn, turn, atol=1e-9)
    assert not turn_of_direction(axes, -true[:, :, 1] + 0.1 * true[:, :, 0]).is_seen.any()


def test_part_beyond_shows_the_turn_whatever_it_swings(lost):
    axes, turn, true = lost
    rest = Rotation.random(random_state=9).as_matrix()
    angle = np.random.default_rng(3).uniform(-1.2, 1.2, FRAMES)[:, None]
    across = np.cos(angle) * true[:, :, 0] + np.sin(angle) * true[:, :, 2]  # any axis across the segment
    swing = Rotation.from_rotvec(np.linspace(-1.3, 1.3, FRAMES)[:, None] * across).as_matrix()
    axial = turn_of_part(axes, swing @ true @ rest.T, rest)
    np.testing.assert_allclose(axial.turn, turn, atol=1e-9)


def test_frames_that_do_not_show_it_lie_between_those_that_do_on_the_shorter_way():
    turn = np.radians([0.0, 170, 99, 99, -170, 99])
    axial = filled(turn, np.array([False, True, False, False, True, False]))
    np.testing.assert_allclose(np.degrees(axial.turn), [170, 170, 170 + 20 / 3, 170 + 40 / 3, 190, 190])
    np.testing.assert_array_equal(filled(turn, np.zeros(6, bool)).turn, 0.0)


def test_what_one_take_shows_says_nothing_of_another():
    turn, is_seen = np.radians([40.0, 0, 0, 0, -60, 0]), np.array([True, False, False, False, True, False])
    axial = filled(turn, is_seen, [slice(0, 2), slice(2, 3), slice(3, 6)])
    np.testing.assert_allclose(np.degrees(axial.turn), [40, 40, 0, -60, -60, -60])


def test_turned_axes_keep_their_length_and_stay_right_handed(lost):
    axes, turn, true = lost
    np.testing.assert_allclose(true[:, :, 1], axes[:, :, 1])
    np.testing.assert_allclose(np.linalg.det(true), 1.0)
    np.testing.assert_allclose(true, axes @ Rotation.from_rotvec(turn[:, None] * np.array([0, 1.0, 0])).as_matrix(), atol=1e-12)
