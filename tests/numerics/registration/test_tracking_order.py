"""Laws of the order in which frames are reached."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from kinetree.tasks.numerics.registration.tracking_order import (
    TrackingOrderSettings,
    limb_motion,
    takes_order,
    tracking_order,
)

SETTINGS = TrackingOrderSettings()


def test_all_frames_learned_from_are_reached_from_their_neighbours() -> None:
    assert tracking_order(np.ones(5, bool), 2).tolist() == [1, 2, -1, 2, 3]


@given(st.lists(st.booleans(), min_size=1, max_size=12), st.data())
def test_every_frame_leads_to_the_reference_and_no_learned_one_through_a_further_one(
    flags: list[bool], data: st.DataObject
) -> None:
    reference = data.draw(st.integers(0, len(flags) - 1))
    learned = np.array(flags)
    learned[reference] = True
    before = tracking_order(learned, reference)
    for t in range(len(flags)):
        way, at = [], t
        while before[at] >= 0:
            assert abs(before[at] - reference) < abs(at - reference)
            at = int(before[at])
            way.append(at)
        assert at == reference
        assert not learned[t] or learned[way].all()


def test_the_order_of_learned_frames_is_that_without_the_others() -> None:
    learned = np.array([1, 0, 1, 1, 0, 0, 1, 1, 0], bool)
    number = np.flatnonzero(learned)
    alone = tracking_order(np.ones(len(number), bool), 2)
    among = tracking_order(learned, int(number[2]))[learned]
    assert among.tolist() == [int(number[b]) if b >= 0 else -1 for b in alone]


def test_every_take_is_reached_by_its_entry_and_from_there_outwards() -> None:
    takes = [slice(0, 3), slice(3, 6), slice(6, 8)]
    before = takes_order(np.ones(8, bool), takes, {1: -1, 5: 0, 6: 3})
    assert before.tolist() == [1, -1, 1, 4, 5, 0, 3, 6]


def walking(speed: np.ndarray, limbs: int = 2) -> np.ndarray:
    """(leaf, frame, station, xyz) limbs that go along x, each frame by so much farther than the one before."""
    place = np.concatenate([[0.0], np.cumsum(speed)])
    stems = np.zeros((limbs, len(place), 4, 3))
    stems[..., 0] = place[:, None]
    stems[..., 1] = np.arange(limbs)[:, None, None]
    return stems


def test_the_motion_of_limbs_is_that_of_the_point_that_moves_most() -> None:
    stems = walking(np.array([1.0, 2.0, 4.0]))
    stems[1, 2, 3] += [0.0, 0.0, 9.0]
    motion = limb_motion(stems, 10.0, 2)
    np.testing.assert_allclose(motion[0], [0.1, np.hypot(0.2, 0.9), np.hypot(0.4, 0.9), np.inf])
    np.testing.assert_allclose(motion[1], [np.hypot(0.3, 0.9), 0.6, np.inf, np.inf])


def test_frames_that_do_not_see_the_same_limbs_are_far_apart() -> None:
    stems = walking(np.zeros(2))
    stems[1, 1] = np.nan
    np.testing.assert_array_equal(limb_motion(stems, 1.0, 2), [[np.inf, np.inf, np.inf], [0.0, np.inf, np.inf]])
    assert np.isinf(limb_motion(stems[:0], 1.0)).all()


def test_slow_frames_are_stepped_over_and_fast_ones_are_not() -> None:
    slow, fast = SETTINGS.moved / 3.5, 2.0 * SETTINGS.moved
    speed = np.array([*[slow] * 9, *[fast] * 3])
    before = tracking_order(np.ones(13, bool), 0, limb_motion(walking(speed), 1.0))
    assert before.tolist() == [-1, 0, 0, 0, 3, 3, 3, 6, 6, 6, 9, 10, 11]


@given(st.lists(st.floats(0.0, 0.1), min_size=1, max_size=20), st.data())
def test_no_step_is_longer_than_limbs_allow_and_all_lead_outwards(speed: list[float], data: st.DataObject) -> None:
    motion = limb_motion(walking(np.array(speed)), 1.0)
    count = len(speed) + 1
    reference = data.draw(st.integers(0, count - 1))
    before = tracking_order(np.ones(count, bool), reference, motion)
    for t in range(count):
        if t == reference:
            assert before[t] == -1
            continue
        assert abs(before[t] - reference) < abs(t - reference)
        step = abs(t - before[t])
        assert step == 1 or motion[step - 1, min(t, before[t])] <= SETTINGS.moved


@given(st.lists(st.floats(0.0, 0.1), min_size=1, max_size=20))
def test_no_frame_is_reached_by_more_steps_than_there_are_frames_before_it(speed: list[float]) -> None:
    before = tracking_order(np.ones(len(speed) + 1, bool), 0, limb_motion(walking(np.array(speed)), 1.0))
    depth = [0]
    for t in range(1, len(before)):
        depth.append(depth[before[t]] + 1)
        assert depth[t] <= t
    assert depth == sorted(depth)


def test_every_take_has_steps_of_its_own() -> None:
    stems = walking(np.zeros(7))
    before = takes_order(np.ones(8, bool), [slice(0, 4), slice(4, 8)], {0: -1, 7: 3}, limb_motion(stems, 1.0))
    assert before.tolist() == [-1, 0, 0, 0, 7, 7, 7, 3]
