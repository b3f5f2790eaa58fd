"""Second differences of motions that are known."""

import numpy as np
import pytest

from kinetree.tasks.numerics.results.evaluation.jitter import jitter, second_differences

T = np.arange(6.0)


def test_even_motion_has_none_and_a_constant_acceleration_is_what_it_is():
    even = T[:, None, None] * np.array([1.0, 2.0, 3.0])
    assert not second_differences(even, range(6)).any()
    falling = (T**2)[:, None, None] * np.array([0.0, 0.0, 1.0])
    assert second_differences(falling, range(6)) == pytest.approx(np.broadcast_to([0.0, 0.0, 2.0], (4, 1, 3)))


def test_gap_between_frames_is_no_jerk():
    even = np.array([0.0, 1, 2, 7, 8, 9])[:, None, None] * np.ones(3)
    assert not second_differences(even, [0, 1, 2, 7, 8, 9]).any()
    assert len(second_differences(even, [0, 1, 2, 7, 8, 9])) == 2


def test_constant_offset_is_an_error_and_no_jitter():
    true = np.random.default_rng(0).normal(size=(6, 2, 3))
    assert jitter(true + 5.0, true, range(6))[0] == pytest.approx(0.0, abs=1e-12)


def test_trembling_by_one_up_and_down_has_second_differences_of_four():
    true = np.zeros((6, 1, 3))
    shaken = true + ((-1) ** np.arange(6))[:, None, None] * np.array([0.0, 1.0, 0.0])
    assert jitter(shaken, true, range(6)) == pytest.approx((4.0, 0.0))


def test_two_frames_or_no_joint_tell_nothing():
    assert jitter(np.ones((2, 1, 3)), np.zeros((2, 1, 3)), [0, 1]) == (0.0, 0.0)
    assert jitter(np.ones((5, 0, 3)), np.zeros((5, 0, 3)), range(5)) == (0.0, 0.0)
