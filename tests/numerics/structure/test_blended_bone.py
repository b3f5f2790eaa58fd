"""Weights of the skin and the motion of a bone, each found while the other is known."""

import numpy as np
from articulated import neck

from kinetree.tasks.numerics.structure.blended_bone import MovingSkin, blended_bone, refitted

BODY = neck()
TRUE = MovingSkin(BODY.V, BODY.x, BODY.area, BODY.W[:, [0, 2, 1]], BODY.R[:, [0, 2, 1]], BODY.t[:, [0, 2, 1]])
"""The neck is the last part."""


def spoilt() -> MovingSkin:
    R, t = TRUE.R.copy(), TRUE.t.copy()
    R[:, -1], t[:, -1] = R[:, 0], t[:, 0]
    return TRUE._replace(R=R, t=t)


def test_the_true_bone_leaves_nothing_and_weights_are_the_true_ones() -> None:
    assert TRUE.squares().max() < 1e-20
    around = TRUE._replace(W=np.full_like(TRUE.W, 1 / 3)).weighed(1e-6)
    assert np.abs(around.squares()).max() < 1e-4
    np.testing.assert_allclose(around.W.sum(axis=1), 1.0)


def test_with_the_true_weights_one_fit_finds_the_motion() -> None:
    found = refitted(spoilt())
    np.testing.assert_allclose(found.R, TRUE.R, atol=1e-6)
    np.testing.assert_allclose(found.t, TRUE.t, atol=1e-6)


def test_a_motion_is_found_as_well_far_from_the_origin() -> None:
    shift = 1e6 * np.array([0.6, -0.64, 0.48])
    start = spoilt()
    far = start._replace(V=start.V + shift, x=start.x + shift, t=start.t + shift - start.R @ shift)
    found, there = refitted(start), refitted(far)
    np.testing.assert_allclose(there.R, found.R, atol=1e-8)
    np.testing.assert_allclose(there.squares(), found.squares(), atol=1e-8)


def test_every_round_explains_the_skin_better() -> None:
    start = spoilt()
    left = [blended_bone(start, 1e-8, rounds).squares().mean() for rounds in (1, 4, 16)]
    assert left[0] > left[1] > left[2]


def test_some_vertices_in_some_frames_keep_their_weights_among_the_parts_that_are_left() -> None:
    few = TRUE.of(np.array([3, 5, 700]), np.array([0, 2]), slice(None, None, 6))
    assert few.x.shape == (4, 3, 3)
    assert few.R.shape == (4, 2, 3, 3)
    np.testing.assert_allclose(few.W.sum(axis=1), 1.0)
    np.testing.assert_array_equal(few.with_bone(few.R[:, 0], few.t[:, 0], 0.25).W[:, -1], 0.25)
