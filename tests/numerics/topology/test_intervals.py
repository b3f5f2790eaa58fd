"""Laws of cutting: a partition, cut where something changes for good and nowhere else."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinetree.tasks.numerics.topology.correlation import correlations
from kinetree.tasks.numerics.topology.intervals import Cue, drops, fixed_intervals, intervals, stacked, steps, z_scores


def bodies(shapes, seed=0, noise=0.002):
    """Histograms of a moving body: one Gaussian per frame at the shape's place, and a little noise."""
    bins = np.arange(100)
    H = np.exp(-0.5 * ((bins[None] - np.asarray(shapes, dtype=float)[:, None]) / 12.0) ** 2)
    H += np.random.default_rng(seed).uniform(0.0, noise, H.shape) * H.max()
    return H / H.sum(axis=1, keepdims=True)


def swaying(frames, seed=0):
    """A place of the histogram that sways a little, as motion does."""
    return 30.0 + 0.6 * np.sin(np.arange(frames) * 1.1 + seed) + np.random.default_rng(seed).normal(0, 0.3, frames)


def pairs(division):
    return list(zip(division.begin.tolist(), division.end.tolist(), strict=True))


def test_a_clean_drop_is_cut_there_and_nowhere_else():
    place = swaying(30)
    place[14:] += 12.0
    division = intervals(bodies(place), {})
    assert pairs(division) == [(0, 13), (14, 29)]
    assert division.cues == (("correlation",),)
    assert int(np.argmax(division.z)) == 13


def test_motion_without_a_change_is_one_interval():
    for seed in range(6):
        assert pairs(intervals(bodies(swaying(40, seed), seed), {})) == [(0, 39)]


def test_a_frame_that_returns_is_noise():
    place = swaying(30)
    place[14] += 12.0
    assert pairs(intervals(bodies(place), {})) == [(0, 29)]


def test_a_change_spread_over_two_transitions_is_one_cut():
    place = swaying(30)
    place[14] += 7.0
    place[15:] += 13.0
    division = intervals(bodies(place), {})
    assert len(division.begin) == 2
    assert division.end[0] in (13, 14)


def test_both_sides_of_a_contact_are_cut():
    place = swaying(40)
    place[12:27] += 12.0
    assert pairs(intervals(bodies(place), {})) == [(0, 11), (12, 26), (27, 39)]


def test_a_drop_reaches_as_far_as_the_score_stays_above_the_lower_threshold():
    place = np.repeat([30.0, 42.0, 55.0], [10, 2, 10])
    H = bodies(place, noise=0.0)
    z = np.zeros(21)
    z[[9, 10, 11]] = [3.0, 1.7, 4.0]
    assert np.flatnonzero(drops(H, z, high=2.0, low=1.5, drop=0.02)).tolist() == [11]
    assert np.flatnonzero(drops(H, z, high=2.0, low=1.8, drop=0.02)).tolist() == [9, 11]
    assert not drops(H, z, high=5.0, low=1.5, drop=0.02).any()
    assert not drops(H, z, high=2.0, low=1.5, drop=0.9).any()


def test_a_small_drop_counts_for_nothing_even_where_all_else_is_still():
    place = np.full(30, 30.0)
    place[15:] += 1.0
    assert 0.0 < 1.0 - correlations(bodies(place, noise=0.0))[14] < 0.02
    assert pairs(intervals(bodies(place, noise=0.0), {})) == [(0, 29)]


@pytest.mark.parametrize("frames", [1, 2, 12])
def test_identical_frames_are_one_interval(frames):
    division = intervals(np.tile(bodies([30.0]), (frames, 1)), {"leaves": Cue(np.ones((frames, 3)), 0.1)})
    assert pairs(division) == [(0, frames - 1)]
    assert division.z.tolist() == [0.0] * (frames - 1)
    assert division.cues == ()


def test_two_frames_are_one_interval_however_different():
    assert pairs(intervals(bodies([20.0, 80.0]), {"leaves": Cue(np.array([[1.0], [0.0]]), 0.1)})) == [(0, 1)]


def test_a_cue_cuts_by_itself_and_can_be_left_out():
    H = bodies(swaying(30))
    profile = np.full((30, 2), 0.6)
    profile[10:, 1] = 0.3
    division = intervals(H, {"leaves": Cue(profile, 0.1)})
    assert pairs(division) == [(0, 9), (10, 29)]
    assert division.cues == (("leaves",),)
    assert pairs(intervals(H, {})) == [(0, 29)]


def test_the_correlation_can_be_left_out():
    place = swaying(30)
    place[14:] += 12.0
    assert pairs(intervals(bodies(place), {}, correlation=False)) == [(0, 29)]


def test_cues_that_agree_make_one_cut_and_are_both_named():
    place = swaying(30)
    place[14:] += 12.0
    profile = np.where(np.arange(30) < 15, 1.0, 0.0)[:, None]
    division = intervals(bodies(place), {"loops": Cue(profile, 0.1)})
    assert pairs(division) in ([(0, 13), (14, 29)], [(0, 14), (15, 29)])
    assert division.cues == (("correlation", "loops"),)


def test_a_step_must_be_sharp_and_must_last():
    level = np.zeros((30, 1))
    level[10:] = 0.3
    assert np.flatnonzero(steps(level, 0.1)).tolist() == [9]
    ramp = np.clip(np.arange(30) - 5, 0, 10)[:, None] * 0.03
    assert not steps(ramp, 0.1).any()
    assert not steps(ramp, 0.07).any()
    assert steps(ramp, 0.05).any()
    spike = np.zeros((30, 1))
    spike[10] = 0.3
    assert not steps(spike, 0.1).any()


def test_a_step_below_the_threshold_is_none():
    level = np.zeros((20, 2))
    level[10:, 1] = 0.3
    assert steps(level, 0.299).any()
    assert not steps(level, 0.301).any()


def test_scores_do_not_change_when_all_changes_are_scaled_together():
    change = np.exp(np.random.default_rng(1).normal(-4.0, 1.0, 50))
    np.testing.assert_allclose(z_scores(1 - change), z_scores(1 - 2 * change), atol=1e-9)


def test_differences_too_small_to_see_have_no_score():
    change = np.full(30, 1e-9)
    change[[4, 11]] = 1e-4
    assert z_scores(1.0 - change).tolist() == [0.0] * 30
    assert z_scores(np.zeros(0)).shape == (0,)


def test_the_fixed_threshold_cuts_wherever_the_correlation_is_below_it():
    C = np.array([0.99, 0.8, 0.97, 0.89, 0.95])
    assert pairs(fixed_intervals(C, 0.9)) == [(0, 1), (2, 3), (4, 5)]
    assert pairs(fixed_intervals(C, -1.0)) == [(0, 5)]
    assert pairs(fixed_intervals(np.zeros(0), 0.9)) == [(0, 0)]


def test_profiles_of_different_lengths_are_padded_with_zeros():
    rows = [np.array([1.0, 0.5]), np.zeros(0), np.array([0.9])]
    np.testing.assert_array_equal(stacked(rows), [[1.0, 0.5], [0.0, 0.0], [0.9, 0.0]])
    assert stacked([np.zeros(0)]).shape == (1, 1)


@settings(deadline=None, max_examples=80)
@given(seed=st.integers(0, 10_000), frames=st.integers(1, 40), minimum=st.integers(1, 6))
def test_intervals_partition_the_frames_and_none_is_too_short(seed, frames, minimum):
    rng = np.random.default_rng(seed)
    profile = rng.integers(0, 3, (frames, 2)).astype(float)
    division = intervals(bodies(rng.uniform(10, 90, frames), seed), {"leaves": Cue(profile, 0.5)}, minimum=minimum)
    covered = [t for begin, end in pairs(division) for t in range(begin, end + 1)]
    assert covered == list(range(frames))
    assert len(division.cues) == len(division.begin) - 1
    assert all(division.cues)
    assert all(end - begin + 1 >= min(minimum, frames) for begin, end in pairs(division))


@settings(deadline=None, max_examples=30)
@given(seed=st.integers(0, 10_000))
def test_a_film_shown_backwards_has_its_steps_at_the_same_places(seed):
    rng = np.random.default_rng(seed)
    profile = np.repeat(rng.uniform(0, 1, 5), 6)[:, None]
    assert steps(profile[::-1], 0.1)[::-1].tolist() == steps(profile, 0.1).tolist()
