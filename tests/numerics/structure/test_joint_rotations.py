"""How far parts turn against each other."""

import numpy as np
import pytest
from limbs import rotation, tube

from kinetree.tasks.numerics.geometry.normals import smoothed_normals
from kinetree.tasks.numerics.structure.joint_rotations import (
    in_between,
    joint_degrees,
    mean_rotation,
    swing,
    turning_range,
    widest_turning_range,
)

WAVE = np.sin(2 * np.pi * np.arange(40) / 40)


def about(axis: tuple[float, float, float], angles: np.ndarray) -> np.ndarray:
    return np.stack([rotation(axis, a) for a in angles])


def test_range_is_the_widest_angle_between_frames_and_two_frames_may_err() -> None:
    turns = about((0.0, 0.0, 1.0), np.deg2rad(30) * WAVE)
    assert turning_range(turns) == pytest.approx(60, abs=2)
    turns[[5, 20]] = rotation((1.0, 0.0, 0.0), 2.0)
    assert turning_range(turns) == pytest.approx(60, abs=4)
    assert turning_range(np.tile(np.eye(3), (40, 1, 1))) == pytest.approx(0, abs=1e-5)


@pytest.mark.parametrize("frames", [5, 9, 15])
def test_what_turns_in_one_of_a_few_frames_has_turned(frames: int) -> None:
    turns = np.tile(np.eye(3), (frames, 1, 1))
    turns[3] = rotation((1.0, 0.0, 0.0), 0.5)
    assert turning_range(turns) == pytest.approx(np.rad2deg(0.5))
    assert turning_range(np.concatenate([turns, np.tile(np.eye(3), (16 - frames, 1, 1))])) == pytest.approx(0, abs=1e-5)


def test_of_many_short_takes_one_wrong_frame_makes_no_turn() -> None:
    turns = np.tile(np.eye(3), (40, 1, 1))
    turns[13] = rotation((1.0, 0.0, 0.0), 0.5)
    spans = np.array([[k, k + 10] for k in range(0, 40, 10)])
    assert widest_turning_range(turns, spans) == pytest.approx(0, abs=1e-5)


def test_mean_of_swings_to_either_side_is_none() -> None:
    assert mean_rotation(about((0.0, 1.0, 0.0), 0.5 * WAVE)) == pytest.approx(np.eye(3), abs=1e-9)


def test_twist_of_a_thin_limb_moves_little_and_a_bend_moves_much() -> None:
    V, _ = tube(flat=1.0)
    area, centre = np.ones(len(V)), np.array([0.0, 0.0, -5.0])
    twist = swing(V, area, centre, about((0.0, 0.0, 1.0), 0.3 * WAVE), above=False)
    bend = swing(V, area, centre, about((1.0, 0.0, 0.0), 0.3 * WAVE), above=False)
    assert twist < 0.3 < bend
    assert bend == pytest.approx(0.3 / np.sqrt(2) * np.sqrt(((V - centre)[:, 1:] ** 2).sum(axis=1).mean()), rel=0.02)


def test_turning_half_the_way_is_in_between_and_turning_by_itself_is_not() -> None:
    whole = about((1.0, 0.0, 0.0), 0.6 * WAVE)
    assert in_between(about((1.0, 0.0, 0.0), 0.3 * WAVE), whole) == pytest.approx(1, abs=1e-9)
    assert in_between(about((0.0, 1.0, 0.0), 0.3 * WAVE), whole) < 0.1
    assert in_between(about((1.0, 0.0, 0.0), 0.3 * np.roll(WAVE, 10)), whole) < 0.5
    assert in_between(about((1.0, 0.0, 0.0), -0.3 * WAVE), whole) == 0


def test_twist_of_a_round_limb_is_no_way_where_only_its_surface_was_seen() -> None:
    centre, turns = np.array([0.0, 0.0, -5.0]), about((0.0, 0.0, 1.0), 0.3 * WAVE)
    for flat, least, most in ((1.0, 0.0, 0.02), (0.4, 0.15, 1.0)):
        V, F = tube(flat=flat)
        N = smoothed_normals(V, F)
        assert least <= swing(V, np.ones(len(V)), centre, turns, False, N) <= most
        bend = about((1.0, 0.0, 0.0), 0.3 * WAVE)
        followed = swing(V, np.ones(len(V)), centre, bend, False)
        assert swing(V, np.ones(len(V)), centre, bend, False, N) == pytest.approx(followed, rel=0.02)


def test_two_frames_are_enough_to_have_turned() -> None:
    assert turning_range(about((0.0, 0.0, 1.0), np.array([0.0, 0.5]))) == pytest.approx(np.rad2deg(0.5))
    assert turning_range(np.eye(3)[None]) == pytest.approx(0)


def test_joints_turn_against_their_parents_and_leaves_do_not() -> None:
    parent = about((0.0, 1.0, 0.0), WAVE)
    child = parent @ about((0.0, 0.0, 1.0), np.deg2rad(30) * WAVE)
    R = np.stack([parent, child, child], axis=1)
    degrees = joint_degrees(R, np.array([-1, 0, 1]), np.array([False, True, False]))
    assert degrees == pytest.approx([0.0, 60.0, 0.0], abs=2)
    assert degrees[1] == pytest.approx(turning_range(parent.transpose(0, 2, 1) @ child))


def test_a_joint_turns_as_far_as_in_the_take_that_turns_it_most() -> None:
    child = np.tile(np.eye(3), (40, 1, 1))
    child[16:18] = about((0.0, 0.0, 1.0), np.array([0.5, 0.5]))
    R, turns = np.stack([np.tile(np.eye(3), (40, 1, 1)), child], axis=1), np.array([False, True])
    takes = [slice(0, 14), slice(14, 20), slice(20, 40)]
    assert joint_degrees(R, np.array([-1, 0]), turns)[1] == pytest.approx(0.0, abs=1e-5), "two of many may be wrong"
    assert joint_degrees(R, np.array([-1, 0]), turns, takes)[1] == pytest.approx(np.rad2deg(0.5))
    between = np.stack([R[:, 0], np.where(np.arange(40)[:, None, None] < 20, np.eye(3), child[16])], axis=1)
    held = joint_degrees(between, np.array([-1, 0]), turns, [slice(0, 20), slice(20, 40)])
    assert held[1] == pytest.approx(np.rad2deg(0.5)), "held otherwise in another take"
