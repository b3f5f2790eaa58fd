"""Borders between parts and the points they turn about."""

import numpy as np
import numpy.typing as npt
import pytest
from articulated import chain, swings
from limbs import rotation

from kinetree.tasks.numerics.structure.rotation_centres import RotationCentresSettings, blend_error, borders, rotation_centres

Floats = npt.NDArray[np.float64]


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


def weakly_turning(noise: Floats) -> Floats:
    """A joint that turns by 3° about one line and by 25° about another, of whose child the place is so wrong."""
    frame = np.arange(len(noise))
    turn = swings(len(noise), 2)
    for f in frame:
        turn[f, 1] = rotation((1, 0, 0), 0.45 * np.sin(0.7 * f)) @ rotation((0, 1, 0), 0.05 * np.cos(0.3 * f))
    body = chain((0.5,), turn)
    t = body.t.copy()
    t[:, 1] += noise
    expected = body.joints[1] + [0.4, 0.0, 0.0]
    prior = RotationCentresSettings(spread=0.35, frames_alike=3.0)
    found = rotation_centres(body.R, t, np.array([[0, 1]]), expected[None], np.ones(1), body.residual, None, prior)
    return np.asarray(found.rest[0] - body.joints[1])


def test_errors_of_single_frames_average_out_and_lasting_ones_do_not() -> None:
    rng = np.random.default_rng(0)
    single = 0.02 * rng.normal(size=(72, 3))
    slow = np.stack([0.02 * np.sqrt(2) * np.sin(np.arange(72) * 0.09 + phase) for phase in (0.0, 1.0, 2.0)], axis=1)
    assert weakly_turning(np.zeros((72, 3))) == pytest.approx([0, 0, 0], abs=1e-3)
    assert abs(weakly_turning(single)[0]) < 0.2
    assert weakly_turning(slow)[0] > 0.3


def test_a_joint_that_runs_away_goes_a_smaller_share_of_the_way() -> None:
    turn = swings(24, 2, degrees=4.0)
    body = chain((0.5,), turn)
    residual = np.full(body.R.shape[:2], 0.02)

    def share(way: float, far: float) -> float:
        expected = body.joints[1:] - [0.0, 0.0, way]
        prior = RotationCentresSettings(far=far)
        found = rotation_centres(body.R, body.t, np.array([[0, 1]]), expected, np.ones(1), residual, None, prior)
        return float((found.rest - expected)[0, 2] / way)

    assert share(0.2, 0.7) == pytest.approx(share(0.2, np.inf), abs=0.05)
    assert share(1.0, 0.7) < share(1.0, np.inf) - 0.1


def test_skin_between_parts_that_it_follows_is_explained_by_them() -> None:
    body = chain((-1.5, 1.5), blend=1.0)
    met = borders(body.V, body.F, body.label)
    assert blend_error(body.V, body.F, body.x, body.label, met.pair, body.R, body.t) == pytest.approx([0, 0], abs=1e-9)
    wrong = blend_error(body.V, body.F, body.x, body.label, met.pair, body.R[:, [2, 0, 1]], body.t[:, [2, 0, 1]])
    assert wrong.min() > 0.05


def test_a_joint_on_a_centre_line_is_held_more_firmly_across_it_than_along_it() -> None:
    body, pair, z = chain((0.5,), swings(24, 2, degrees=4.0, axes=2)), np.array([[0, 1]]), np.diag([0.0, 0.0, 1.0])[None]
    residual, way = np.full(body.R.shape[:2], 0.02), np.array([0.3, 0.3, 0.3])
    expected = body.joints[1:] - way

    def share(lines: Floats | None) -> Floats:
        prior = RotationCentresSettings(spread=0.35, across=0.12)
        found = rotation_centres(body.R, body.t, pair, expected, np.ones(1), residual, None, prior, lines)
        return np.asarray((found.rest - expected)[0] / way)

    free, on_line, in_part = share(None), share(z), share(0.5 * z)
    assert (on_line[:2] < 0.5 * free[:2]).all()
    assert on_line[2] > free[2] + 0.1
    assert (on_line[:2] < in_part[:2]).all()
    assert (in_part[:2] < free[:2]).all()
    np.testing.assert_allclose(share(0.0 * z), free, atol=0.02)


def test_a_line_that_is_wrong_does_not_hold_a_joint_whose_motion_is_certain() -> None:
    """What a wrong place leaves would count as noise, and hold the joint there the more."""
    body, pair, z = chain((0.5,), swings(48, 2, degrees=20.0, axes=2)), np.array([[0, 1]]), np.diag([0.0, 0.0, 1.0])[None]
    residual, off = np.full(body.R.shape[:2], 0.01), np.array([[0.35, 0.35, 0.0]])
    prior = RotationCentresSettings(spread=0.35, across=0.12, frames_alike=3.0, far=0.7)
    found = rotation_centres(body.R, body.t, pair, body.joints[1:] + off, np.ones(1), residual, None, prior, z)
    assert np.linalg.norm(found.rest[0] - body.joints[1]) < 0.4 * np.linalg.norm(off)
