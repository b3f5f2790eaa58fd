"""What a frame says of the body."""

import numpy as np
import pytest
from fitting import arms, surface_at, true, turned
from limbs import rotation

from kinetree.tasks.numerics.structure.surface_matches import equations, followed, searched, uncovered, visible_share

AWAY = rotation((0.0, 0.0, 1.0), 0.9)


def test_body_where_it_is_explains_all_and_is_shown_in_full() -> None:
    known, body = arms()
    target = surface_at(known, body, 3)
    found = searched(body, true(known, 3), target)
    assert uncovered(body, target, found).mean() < 0.15
    assert visible_share(body, target, found).min() > 0.9


def test_arm_that_the_frame_lost_is_shown_nowhere_and_believes_nothing() -> None:
    known, body = arms()
    target = surface_at(known, body, 3, lost=2)
    found = searched(body, true(known, 3), target)
    share = visible_share(body, target, found)
    assert share[2] < 0.1 < 0.9 < share[[0, 1, 3]].min()
    said = equations(body, target, found, 0.02 * body.size, 0.05)
    far = np.linalg.norm(body.V[body.sample] - body.rest[2], axis=1) > 8
    assert said.plane[: len(body.sample)][far & (body.label[body.sample] == 2)].max() < 1e-6


def test_arm_that_is_elsewhere_leaves_its_surface_unexplained() -> None:
    known, body = arms()
    target = surface_at(known, body, 3)
    found = searched(body, turned(true(known, 3), 1, AWAY), target)
    share = np.bincount(known.label, known.area)[1] / known.area.sum()
    assert uncovered(body, target, found).mean() > 0.5 * share
    assert visible_share(body, target, found)[1] < 0.3


def test_following_a_small_step_finds_what_searching_finds() -> None:
    known, body = arms()
    target = surface_at(known, body, 3)
    at = true(known, 3)
    step = turned(at, 2, rotation((1.0, 0.0, 0.0), 0.02))
    one, two = searched(body, step, target), followed(body, step, target, searched(body, at, target))
    assert uncovered(body, target, two).mean() == pytest.approx(uncovered(body, target, one).mean(), abs=0.002)
