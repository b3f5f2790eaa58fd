"""Laws of limbs tried in other rolls, on an egg-shaped bar and on a round one."""

import numpy as np
import pytest
from limbs import LENGTH, rotation, tube
from shipped import GRAPH

from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.registration.deformation import Pose, at_rest
from kinetree.tasks.numerics.registration.deformation_graph import deformation_graph
from kinetree.tasks.numerics.registration.roll_candidates import RollCandidatesSettings, limbs, roll_candidates, rolled


def egg(**cut):
    """A tube whose section is an egg, so that one roll alone fits."""
    V, F = tube(flat=0.6, **cut)
    return V * np.stack([np.ones(len(V)), 1.0 + 0.35 * V[:, 0], np.ones(len(V))], axis=1), F


@pytest.fixture(scope="module")
def body():
    return deformation_graph(*egg(), GRAPH._replace(nodes=80))


@pytest.fixture(scope="module")
def cluster(body):
    return (body.g[:, 2] > 0).astype(np.int64)


def rolled_body(body, angle):
    """(target, true pose) where all turned about the tube's own axis by an angle."""
    R = rotation((0, 0, 1), angle)
    V, F = egg(around=29, along=57, start=0.07)
    pose = Pose(np.tile(R, (len(body.g), 1, 1)), body.g @ R.T)
    return Target.of(V @ R.T, F, body.size), pose


def degrees(R, S):
    return np.degrees(np.arccos(np.clip((np.einsum("jxy,jxy->j", R, S) - 1) / 2, -1, 1)))


@pytest.mark.parametrize("angle", [1.0, 2.0, -1.5])
def test_the_roll_that_was_lost_fits_best_and_is_told_by_its_angle(body, cluster, angle):
    target, true = rolled_body(body, angle)
    found = roll_candidates(body, at_rest(body), target, cluster)
    for k, limb in enumerate(limbs(body, cluster)):
        best = found.misfit[k].argmin()
        assert found.misfit[k, best] < 0.5 * found.misfit[k, 0]
        assert found.angle[k, best] * limb.axis[2] == pytest.approx(angle, abs=0.06)
        now = rolled(body, at_rest(body), cluster, found, np.where(np.arange(2) == k, best, -1))
        assert degrees(now.rotation[limb.node], true.rotation[limb.node]).max() < 3.0
        assert np.linalg.norm(now.translation - true.translation, axis=1)[limb.node].max() < 0.01 * LENGTH
        other = np.setdiff1d(np.arange(len(body.g)), limb.node)
        np.testing.assert_array_equal(now.translation[other], body.g[other])


def test_a_limb_that_fits_fits_best_where_it_is(body, cluster):
    target, true = rolled_body(body, 0.7)
    found = roll_candidates(body, true, target, cluster)
    assert (found.misfit[:, 0] <= found.misfit.min(axis=1) + 1e-3).all()
    assert np.abs(found.angle[:, 0]).max() < 0.05


def test_what_is_round_fits_in_every_roll():
    round_body = deformation_graph(*tube(flat=1.0), GRAPH._replace(nodes=80))
    target = Target.of(*tube(around=29, along=57, flat=1.0), round_body.size)
    found = roll_candidates(round_body, at_rest(round_body), target, np.zeros(len(round_body.g), np.int64))
    assert np.ptp(found.misfit, axis=1).max() < 0.02


def test_clusters_too_small_or_as_wide_as_long_have_no_axis(body):
    assert limbs(body, np.arange(len(body.g))) == []
    assert limbs(body, (np.abs(body.g[:, 2]) < 1.2).astype(np.int64) - 1) == []


def test_a_frame_out_of_reach_fits_in_no_roll(body, cluster):
    V, F = egg()
    found = roll_candidates(body, at_rest(body), Target.of(V + 100.0 * LENGTH, F, body.size), cluster)
    assert found.misfit.shape == (2, RollCandidatesSettings().starts)
    assert (found.misfit == 1.0).all()


def test_results_are_equal_to_the_last_bit_again(body, cluster):
    target, _ = rolled_body(body, 1.0)
    for first, again in zip(*(roll_candidates(body, at_rest(body), target, cluster) for _ in range(2)), strict=True):
        np.testing.assert_array_equal(first, again)
