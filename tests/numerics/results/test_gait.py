"""Steps whose times are known."""

import numpy as np
import pytest

from kinetree.tasks.numerics.results.gait import gait_events, strides, symmetry_index

RATE, PERIOD = 30.0, 1.1
TIMES = np.arange(150) / RATE


def walking(swing=0.5, speed=0.0, phase=0.5, noise=0.0):
    """Two feet that swing along x by a cosine, on a body that travels; the second a share of a stride later."""
    pelvis = np.column_stack([speed * TIMES, np.full_like(TIMES, 0.9), 0 * TIMES])
    feet = np.zeros((len(TIMES), 2, 3))
    for foot, late in enumerate((0.0, phase)):
        feet[:, foot, 0] = speed * TIMES + swing * np.cos(2 * np.pi * (TIMES / PERIOD - late))
    feet += np.random.default_rng(0).normal(scale=max(noise, 1e-12), size=feet.shape)
    ahead = np.tile([1.0, 0.0, 0.0], (len(TIMES), 1))
    return gait_events(feet, feet, pelvis, ahead, [0.9, 0.9], TIMES)


@pytest.mark.parametrize("speed", [0.0, 1.3])
@pytest.mark.parametrize("noise", [0.0, 0.004])
def test_strikes_and_offs_are_found_within_a_frame_on_the_ground_and_on_a_treadmill(speed, noise):
    events = walking(speed=speed, noise=noise)
    for foot, late in enumerate((0.0, 0.5)):
        for kind, at in (("strike", late), ("off", late + 0.5)):
            times = np.array([e.time for e in events if (e.foot, e.kind) == (foot, kind)])
            true = (np.arange(-1, 6) + at) * PERIOD
            true = true[(true > 0.5 / RATE) & (true < TIMES[-1] - 0.5 / RATE)]
            assert len(times) == len(true)
            np.testing.assert_allclose(times, true, atol=1 / RATE)


def test_events_are_in_order_and_strides_and_stances_have_their_length():
    events = walking()
    assert [e.time for e in events] == sorted(e.time for e in events)
    for foot in (0, 1):
        stride, stance = strides(events, foot)
        np.testing.assert_allclose(stride, PERIOD, atol=0.01)
        np.testing.assert_allclose(stance, PERIOD / 2, atol=0.01)


def test_feet_that_hardly_swing_do_not_walk():
    assert walking(swing=0.1) == []
    assert walking(swing=0.14) != []


def test_symmetry_index_is_zero_for_equal_sides_and_changes_sign_with_them():
    assert symmetry_index(0.6, 0.6) == 0.0
    assert symmetry_index(0.5, 0.6) == pytest.approx(-symmetry_index(0.6, 0.5))
    assert symmetry_index(0.5, 0.6) == pytest.approx(100 * 0.1 / 0.55)
