"""Laws of pieces tried in other turns, on an oval bar and on one whose upper half is twisted."""

import numpy as np
import pytest
from limbs import LENGTH, rotation, tube

from kinetree.tasks.numerics.correspondence import Target
from kinetree.tasks.numerics.deformation import Pose, at_rest
from kinetree.tasks.numerics.retried import retried
from kinetree.tasks.numerics.template import TemplateSettings, template


def egg(**cut):
    """A tube whose section is an egg, so that one turn alone fits."""
    V, F = tube(flat=0.6, **cut)
    return V * np.stack([np.ones(len(V)), 1.0 + 0.35 * V[:, 0], np.ones(len(V))], axis=1), F


@pytest.fixture(scope="module")
def body():
    return template(*egg(), TemplateSettings(nodes=80))


@pytest.fixture(scope="module")
def piece(body):
    return (body.g[:, 2] > 0).astype(np.int64)


def twisted(body, angle):
    """(target, true pose) where all turned about the tube's own axis by an angle."""
    R = rotation((0, 0, 1), angle)
    V, F = egg(around=29, along=57, start=0.07)
    pose = Pose(np.tile(R, (len(body.g), 1, 1)), body.g @ R.T)
    return Target.of(V @ R.T, F, body.size), pose


def degrees(R, S):
    return np.degrees(np.arccos(np.clip((np.einsum("jxy,jxy->j", R, S) - 1) / 2, -1, 1)))


@pytest.mark.parametrize("angle", [1.0, 2.0, -1.5])
def test_a_lost_twist_is_found(body, piece, angle):
    target, true = twisted(body, angle)
    found = retried(body, at_rest(body), target, piece)
    assert degrees(found.rotation, true.rotation).max() < 3.0
    assert np.linalg.norm(found.translation - true.translation, axis=1).max() < 0.01 * LENGTH


def test_a_piece_that_fits_is_left_as_it_is_to_the_last_bit(body, piece):
    target, true = twisted(body, 0.7)
    found = retried(body, true, target, piece)
    np.testing.assert_array_equal(found.rotation, true.rotation)
    np.testing.assert_array_equal(found.translation, true.translation)


def test_only_the_piece_that_is_wrong_changes(body, piece):
    target, true = twisted(body, 1.5)
    start = Pose(
        np.where((piece == 1)[:, None, None], np.eye(3), true.rotation),
        np.where((piece == 1)[:, None], body.g, true.translation),
    )
    found = retried(body, start, target, piece)
    np.testing.assert_array_equal(found.rotation[piece == 0], true.rotation[piece == 0])
    assert degrees(found.rotation, true.rotation).max() < 3.0


def test_what_is_round_is_never_turned():
    V, F = tube(flat=1.0)
    round_body = template(V, F, TemplateSettings(nodes=80))
    frame = tube(around=29, along=57, flat=1.0)
    found = retried(round_body, at_rest(round_body), Target.of(*frame, round_body.size), np.zeros(len(round_body.g), np.int64))
    np.testing.assert_array_equal(found.rotation, at_rest(round_body).rotation)


def test_pieces_too_small_to_judge_and_frames_out_of_reach_change_nothing(body):
    target, _ = twisted(body, 1.5)
    alone = np.arange(len(body.g))
    np.testing.assert_array_equal(retried(body, at_rest(body), target, alone).translation, body.g)
    V, F = egg()
    away = Target.of(V + 100.0 * LENGTH, F, body.size)
    np.testing.assert_array_equal(retried(body, at_rest(body), away, 0 * alone).translation, body.g)


def test_results_are_equal_to_the_last_bit_again(body, piece):
    target, _ = twisted(body, 1.0)
    first, again = (retried(body, at_rest(body), target, piece) for _ in range(2))
    np.testing.assert_array_equal(first.rotation, again.rotation)
    np.testing.assert_array_equal(first.translation, again.translation)
