"""Laws of following leaves: a track keeps its limb, and what is unsafe is not done."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinetree.tasks.numerics.topology.leaves import Gap, bridged, fixed_leaves, follow, follow_paper, gaps

ROOTS = np.array([[0.1, 0.0, 0.0], [-0.1, 0.0, 0.0], [0.0, 0.3, 0.5]])


def limb(root, tip, stations=5):
    return root + np.linspace(0.1, 1.0, stations)[:, None] * (tip - root)


def walk(frames=24):
    """Three limbs; the tips of the first two swing and change places again and again, by far more than lies between them."""
    swing = 0.25 * np.sin(2 * np.pi * (np.arange(frames) + 0.5) / 8.0)
    tips = np.zeros((frames, 3, 3))
    tips[:, 0] = np.stack([0.03 + 0 * swing, swing, -0.5 + 0 * swing], axis=1)
    tips[:, 1] = np.stack([-0.03 + 0 * swing, -swing, -0.5 + 0 * swing], axis=1)
    tips[:, 2] = [0.0, 0.4, 0.9]
    return [np.stack([limb(r, tip) for r, tip in zip(ROOTS, frame, strict=True)]) for frame in tips]


def followed(clip, value=None, shift=0.0, scale=1.0, **options):
    frames = len(clip)
    centre = np.zeros((frames, 3)) + shift
    value = [np.full(len(S), 0.8) for S in clip] if value is None else value
    moved = [scale * S + centre[t] for t, S in enumerate(clip)]
    return follow(moved, value, np.full(frames, scale), centre, **options)


def without(clip, track, frames):
    return [np.delete(S, track, axis=0) if t in frames else S for t, S in enumerate(clip)]


def test_limbs_whose_tips_cross_keep_their_tracks():
    assert followed(walk()).tolist() == [[0] * 24, [1] * 24, [2] * 24]


@settings(deadline=None, max_examples=25)
@given(seed=st.integers(0, 10_000))
def test_the_order_of_leaves_within_a_frame_means_nothing(seed):
    rng = np.random.default_rng(seed)
    orders = [np.arange(3)] + [rng.permutation(3) for _ in range(23)]
    tracks = followed([S[order] for S, order in zip(walk(), orders, strict=True)])
    assert tracks.shape == (3, 24)
    for k in range(3):
        assert [int(orders[t][tracks[k, t]]) for t in range(24)] == [k] * 24


def test_place_and_unit_of_the_clip_mean_nothing():
    drift = np.linspace(0.0, 50.0, 24)[:, None] * np.array([1.0, 2.0, 0.5])
    np.testing.assert_array_equal(followed(walk(), shift=drift), followed(walk()))
    np.testing.assert_array_equal(followed(walk(), shift=drift, scale=1000.0), followed(walk()))


def test_a_lost_leaf_comes_back_to_its_track_and_the_gap_is_recorded():
    tracks = followed(without(walk(), 0, range(8, 15)))
    assert len(tracks) == 3
    assert (tracks[0] >= 0).tolist() == [t not in range(8, 15) for t in range(24)]
    assert gaps(tracks) == [Gap(0, 8, 14)]


def test_two_limbs_lost_together_at_one_place_come_back_as_new_tracks():
    clip = [np.stack([limb(r, tip) for r, tip in ((ROOTS[2], [0.0, 0.4, 0.9]), (x, x - [0, 0, 0.5]), (y, y - [0, 0, 0.5]))])
            for x, y in [(np.array([0.01, 0.0, 0.0]), np.array([-0.01, 0.0, 0.0]))] * 12]  # fmt: skip
    hidden = [S[:1] if 4 <= t < 8 else S for t, S in enumerate(clip)]
    shifted = [S + (np.array([0.0, 0.05, 0.0]) if t >= 8 else 0.0) for t, S in enumerate(hidden)]
    tracks = followed(shifted)
    assert len(tracks) == 5
    assert (tracks[1:3, 8:] < 0).all()


def test_a_leaf_of_another_height_is_another_leaf():
    clip = walk()
    value = [np.array([0.8, 0.8, 0.8 if t < 12 else 0.5]) for t in range(24)]
    tracks = followed(clip, value)
    assert len(tracks) == 4
    assert (tracks[2] >= 0).tolist() == [t < 12 for t in range(24)]
    assert gaps(tracks) == [Gap(2, 12, 23)]
    assert len(followed(clip, value, likeness=1.0)) == 3


def test_a_lost_limb_does_not_pull_its_neighbours_along():
    row = np.array([[0.15 * k, 0.0, 0.0] for k in range(6)])[:, None]
    tracks = followed([row[:5]] * 3 + [row[1:]] * 3)
    assert tracks[:, 3].tolist() == [-1, 0, 1, 2, 3, 4]
    assert tracks[5].tolist() == [-1, -1, -1, 4, 4, 4]


def test_no_leaves_make_no_tracks():
    none = [np.zeros((0, 5, 3))] * 4
    assert followed(none).shape == (0, 4)
    assert follow([], [], np.zeros(0), np.zeros((0, 3))).shape == (0, 0)
    assert gaps(np.zeros((0, 4), dtype=np.int64)) == []


def test_a_leaf_that_appears_later_is_a_track_from_then_on():
    tracks = followed(without(walk(), 2, range(5)))
    assert tracks.shape == (3, 24)
    assert (tracks[2] >= 0).tolist() == [t >= 5 for t in range(24)]
    assert gaps(tracks) == []


def test_the_fixed_set_of_an_interval_are_the_tracks_seen_often_enough():
    tracks = followed(without(walk(), 0, range(8, 15)))
    assert fixed_leaves(tracks, 0, 7).tolist() == [0, 1, 2]
    assert fixed_leaves(tracks, 8, 14).tolist() == [1, 2]
    assert fixed_leaves(tracks, 0, 23).tolist() == [0, 1, 2]
    assert fixed_leaves(tracks, 0, 23, share=1.0).tolist() == [1, 2]


def test_short_gaps_are_bridged_on_a_straight_line_and_long_ones_are_not():
    line = [np.array([[[float(t), 0.0, 0.0]], [[0.0, 5.0, 0.0]]]) for t in range(12)]
    hidden = [S[1:] if t in (3, 4, 8, 9, 10) else S for t, S in enumerate(line)]
    tracks = np.array([[0, 0, 0, -1, -1, 0, 0, 0, -1, -1, -1, 0], [1, 1, 1, 0, 0, 1, 1, 1, 0, 0, 0, 1]])
    X, is_seen = bridged(tracks, hidden, longest=2)
    np.testing.assert_allclose(X[0, :8, 0], np.arange(8.0))
    assert np.isnan(X[0, 8:11]).all()
    np.testing.assert_array_equal(is_seen, tracks >= 0)


def test_mutual_nearest_neighbours_follow_slow_tips_from_the_first_frame():
    tips = [np.array([[t * 0.01, 0.0, 0.0], [1.0, t * 0.01, 0.0]]) for t in range(5)]
    up = [np.tile([0.0, 0.0, 1.0], (2, 1))] * 5
    assert follow_paper(tips, up).tolist() == [[0] * 5, [1] * 5]
    assert follow_paper([tips[0][:1], *tips[1:]], [up[0][:1], *up[1:]]).tolist() == [[0] * 5]


def test_a_match_whose_normal_flips_ends_the_track():
    tips = [np.zeros((1, 3))] * 4
    normals = [np.array([[0.0, 0.0, 1.0]])] * 2 + [np.array([[0.0, 0.0, -1.0]])] * 2
    assert follow_paper(tips, normals).tolist() == [[0, 0, -1, -1]]


def test_a_match_that_is_not_mutual_is_none():
    tips = [np.array([[0.0, 0, 0], [1.0, 0, 0]]), np.array([[0.1, 0, 0]])]
    up = [np.tile([0.0, 0.0, 1.0], (2, 1)), np.array([[0.0, 0.0, 1.0]])]
    assert follow_paper(tips, up).tolist() == [[0, 0], [1, -1]]


@pytest.mark.parametrize("frames", [0, 1])
def test_hardly_any_frames_are_followed_too(frames):
    assert follow_paper([np.zeros((2, 3))] * frames, [np.ones((2, 3))] * frames).shape == (2 * frames, frames)
