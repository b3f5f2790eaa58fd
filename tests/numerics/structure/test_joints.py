"""Borders between parts and the points they turn about."""

import numpy as np
import pytest
from articulated import chain, swings
from limbs import rotation

from kinetree.tasks.numerics.structure.joints import blend_centres, blend_error, borders, rotation_centres


def test_border_of_a_bent_tube_is_a_ring_around_its_joint() -> None:
    body = chain((0.13,))
    met = borders(body.V, body.F, body.label)
    assert met.pair.tolist() == [[0, 1]]
    assert met.centre[0] == pytest.approx([0, 0, 0.13], abs=0.15)
    assert met.radius[0] == pytest.approx(1.0, abs=0.05)
    assert met.length[0] == pytest.approx(2 * np.pi, rel=0.35)


def test_ball_joint_is_found_wherever_the_border_is() -> None:
    body = chain((0.5,), swings(24, 2, axes=2))
    off = np.array([[0.6, -0.3, 1.4]])
    found = rotation_centres(body.R, body.t, np.array([[0, 1]]), off, np.ones(1), body.residual)
    assert found.rest[0] == pytest.approx(body.joints[1], abs=1e-6)
    assert found.drift[0] == pytest.approx(0.0, abs=1e-6)


def test_hinge_lies_on_its_axis_and_there_at_the_middle_of_the_border() -> None:
    body = chain((0.5,), swings(24, 2, axes=1))
    expected = np.array([[0.3, 0.2, 0.9]])
    found = rotation_centres(body.R, body.t, np.array([[0, 1]]), expected, np.ones(1), body.residual)
    assert found.rest[0] == pytest.approx([0.3, 0.0, 0.5], abs=1e-6)


def test_a_frame_in_which_a_part_was_lost_does_not_move_the_joint() -> None:
    body = chain((0.5,), swings(24, 2))
    t = body.t.copy()
    t[7, 1] += [3.0, -2.0, 4.0]
    met = borders(body.V, body.F, body.label)
    found = rotation_centres(body.R, t, met.pair, met.centre, met.radius, body.residual)
    assert found.rest[0] == pytest.approx(body.joints[1], abs=0.05)
    trust = np.ones((24, 2))
    trust[7, 1] = 0.0
    found = rotation_centres(body.R, t, met.pair, met.centre, met.radius, body.residual, trust)
    assert found.rest[0] == pytest.approx(body.joints[1], abs=0.01)


def test_joint_moves_with_the_reference() -> None:
    body = chain((0.5,), swings(24, 2, axes=1))
    Q, shift = rotation((1.0, 2.0, 0.5), 1.1), np.array([3.0, -7.0, 2.0])
    V = body.V @ Q.T + shift
    R = body.R @ Q.T
    t = body.t - np.einsum("tpxy,y->tpx", R, shift)
    residual = np.full(body.R.shape[:2], 0.01)
    here, there = borders(body.V, body.F, body.label), borders(V, body.F, body.label)
    one = rotation_centres(body.R, body.t, here.pair, here.centre, here.radius, residual)
    other = rotation_centres(R, t, there.pair, there.centre, there.radius, residual)
    assert other.rest[0] == pytest.approx(Q @ one.rest[0] + shift, abs=1e-9)


def test_skin_between_parts_that_it_follows_is_explained_by_them() -> None:
    body = chain((-1.5, 1.5), blend=1.0)
    met = borders(body.V, body.F, body.label)
    assert blend_error(body.V, body.F, body.x, body.label, met.pair, body.R, body.t) == pytest.approx([0, 0], abs=1e-9)
    wrong = blend_error(body.V, body.F, body.x, body.label, met.pair, body.R[:, [2, 0, 1]], body.t[:, [2, 0, 1]])
    assert wrong.min() > 0.05


def test_blend_is_where_the_surface_goes_over() -> None:
    body = chain((-1.5, 1.5), blend=1.0)
    share = np.stack([body.W[:, 1] + body.W[:, 2], body.W[:, 2], np.ones(len(body.V))], axis=1)
    middle = blend_centres(body.V, body.area, share)
    assert middle[:2] == pytest.approx(body.joints[1:], abs=0.1)
    assert np.isnan(middle[2]).all()
