"""Laws of what a part would be missed by."""

import numpy as np
import pytest
from limbs import bent, rotation, tube

from kinetree.tasks.numerics.structure.removal_cost import candidates, removal_cost
from kinetree.tasks.numerics.structure.score_spans import score_spans

ANGLES = (0.0, 0.5, 1.0, -0.5)


def asked(x, V, member, R, bone=0.0, slip=1.0, takes=None):
    t, other = np.zeros((len(x), R.shape[1], 3)), np.array([0, 1])
    N = V * [1, 1, 0] / np.linalg.norm(V[:, :2] + 1e-9, axis=1)[:, None]
    ones, spans = np.ones(x.shape[:2]), score_spans(len(x), takes)
    return removal_cost(V, N, x, ones, np.ones(len(V)), member, 2, other, 2, R, t, bone, slip, 0.0, 0.0, spans)


def test_a_slice_that_two_parts_blend_to_is_not_missed_and_a_bone_that_turns_for_itself_is():
    V, _ = tube()
    low, high = np.tile(np.eye(3), (4, 1, 1)), np.stack([rotation((1, 0, 0), a) for a in ANGLES])
    share = (V[:, 2, None] + 5) / 10
    x = np.stack([(1 - share) * V + share * (V @ R.T) for R in high])
    half = np.stack([rotation((1, 0, 0), a / 2) for a in ANGLES])
    member = np.flatnonzero(np.abs(V[:, 2]) < 0.5)
    R = np.stack([low, high, half], axis=1)
    assert asked(x, V, member, R) < 1e-6
    assert asked(x, V, member, R, bone=1.0) > 0.1
    turned = np.stack([rotation((0, 1, 0), a) for a in ANGLES])
    own = np.stack([V @ r.T for r in turned])
    assert asked(own, V, member, np.stack([low, high, turned], axis=1)) > 0.1


def test_twist_of_a_round_tube_about_its_own_axis_is_little_evidence():
    V, _ = tube(flat=1.0)
    low = np.tile(np.eye(3), (4, 1, 1))
    twist = np.stack([rotation((0, 0, 1), a / 10) for a in ANGLES])
    x = np.stack([V @ r.T for r in twist])
    member, R = np.flatnonzero(np.abs(V[:, 2]) < 2), np.stack([low, low, twist], axis=1)
    full, slipping = asked(x, V, member, R), asked(x, V, member, R, slip=0.3)
    assert slipping < 0.35 * full
    bend = np.stack([rotation((1, 0, 0), a / 10) for a in ANGLES])
    x, R = np.stack([bent(V, a / 10) for a in ANGLES]), np.stack([low, low, bend], axis=1)
    far = np.flatnonzero(V[:, 2] > 2)
    assert asked(x, V, far, R, slip=0.3) > 0.6 * asked(x, V, far, R)


def test_what_happens_in_few_frames_counts_more_than_in_the_mean():
    V, _ = tube()
    low = np.tile(np.eye(3), (16, 1, 1))
    once = low.copy()
    once[5] = rotation((1, 0, 0), 0.4)
    x = np.stack([V @ r.T for r in once])
    member = np.flatnonzero(V[:, 2] > 2)
    found = asked(x, V, member, np.stack([low, low, once], axis=1))
    rms = np.sqrt(((V - x[5]) ** 2).sum(axis=1)[member].mean())
    assert found == pytest.approx(rms / 16**0.25)
    takes = [slice(0, 4), slice(4, 8), slice(8, 16)]
    assert asked(x, V, member, np.stack([low, low, once], axis=1), takes=takes) == pytest.approx(rms / 4**0.25)


def test_what_one_take_shows_costs_what_it_costs_in_that_take_alone():
    V, _ = tube()
    rng = np.random.default_rng(3)
    shown = np.stack([rotation((1, 0, 0), a) for a in ANGLES])
    low = np.tile(np.eye(3), (12, 1, 1))
    turned = low.copy()
    turned[4:8] = shown
    x = np.stack([V @ r.T for r in turned]) + 0.01 * rng.normal(size=(12, *V.shape))
    member, R = np.flatnonzero(V[:, 2] > 2), np.stack([low, low, turned], axis=1)
    alone = asked(x[4:8], V, member, R[4:8], bone=1.0)
    takes = [slice(0, 4), slice(4, 8), slice(8, 12)]
    assert asked(x, V, member, R, bone=1.0) < 0.8 * alone
    assert asked(x, V, member, R, bone=1.0, takes=takes) == pytest.approx(alone, rel=1e-9)


def test_candidates_are_the_neighbours_and_the_largest_behind_them():
    near = np.zeros((6, 6), np.int64)
    for a, b, edges in ((0, 1, 5), (0, 2, 9), (1, 3, 4), (2, 4, 4), (4, 5, 4)):
        near[a, b] = near[b, a] = edges
    other, touches = candidates(near, np.array([1, 1, 1, 0.1, 0.5, 1]), 0)
    np.testing.assert_array_equal(other, [2, 1, 4, 3])
    assert touches == 2
