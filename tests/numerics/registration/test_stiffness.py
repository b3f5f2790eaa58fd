"""Laws of stiffness learned from a sequence, on a tube with one joint."""

import numpy as np
import pytest
from limbs import bent, rotation, tube
from shipped import FITTING

from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.registration.deformation import Pose, at_rest, fit, shape
from kinetree.tasks.numerics.registration.stiffness import (
    PASSES,
    StiffnessSettings,
    learned_stiffness,
    loose_between_clusters,
    loose_limb_ends,
    refit_pass,
)

SETTINGS = StiffnessSettings()
ANGLES = (0.2, 0.4, 0.6)


@pytest.fixture(scope="module")
def sequence(body):
    V, F = tube(around=29, along=57, start=0.07)
    targets, poses, pose = [], [], at_rest(body)
    for angle in ANGLES:
        targets.append(Target.of(bent(V, angle), F, body.size))
        pose = fit(body, pose, targets[-1], FITTING).pose
        poses.append(pose)
    return targets, poses


def test_passes_beyond_the_last_that_is_described_do_as_that_one():
    assert [refit_pass(number) for number in range(5)] == [*PASSES, PASSES[-1], PASSES[-1]]


def middle(body):
    """(edge,) how far from the joint the middle of each edge lies, along the tube."""
    return np.abs(body.g[body.edge, 2].mean(axis=1))


def test_stiffness_is_low_at_the_bend_and_high_elsewhere(body, sequence):
    s = learned_stiffness(body, sequence[1])
    bend, bone = s[middle(body) < 0.7], s[middle(body) > 2.0]
    assert bend.mean() < 0.5 * bone.mean()
    assert np.median(bend) < np.quantile(bone, 0.1)


def test_a_body_that_only_moves_as_a_whole_is_stiff_everywhere(body):
    poses = [Pose(np.tile(R, (len(body.node), 1, 1)), body.g @ R.T + 1.0) for R in (rotation((1, 1, 0), a) for a in ANGLES)]
    np.testing.assert_allclose(learned_stiffness(body, poses), 1.0, atol=1e-12)


def test_an_edge_that_bends_by_the_bound_counts_half(body):
    pose = at_rest(body)
    stretched = Pose(pose.rotation, pose.translation * (1 + SETTINGS.bending))
    np.testing.assert_allclose(learned_stiffness(body, [stretched]), 0.5, atol=1e-12)


def test_the_order_of_frames_does_not_matter_to_the_last_bit(body, sequence):
    poses = sequence[1]
    np.testing.assert_array_equal(learned_stiffness(body, poses[::-1]), learned_stiffness(body, poses))


def test_a_frame_at_rest_makes_nothing_softer(body, sequence):
    assert (learned_stiffness(body, [*sequence[1], at_rest(body)]) >= learned_stiffness(body, sequence[1])).all()


def test_what_bends_in_one_take_is_no_stiffer_for_takes_that_hold_it(body, sequence):
    poses = [*sequence[1], *[at_rest(body)] * 9]
    alone = learned_stiffness(body, sequence[1])
    takes = [slice(0, len(ANGLES)), slice(len(ANGLES), len(poses))]
    np.testing.assert_array_equal(learned_stiffness(body, poses, takes=takes), alone)
    np.testing.assert_array_equal(learned_stiffness(body, sequence[1], takes=takes[:1]), alone)
    assert learned_stiffness(body, poses).min() > 1.5 * alone.min()


def test_a_refit_with_learned_stiffness_is_no_worse_and_keeps_the_turning(body, sequence):
    targets, poses = sequence
    s = learned_stiffness(body, poses)
    for angle, target, pose in zip(ANGLES, targets, poses, strict=True):
        again = fit(body, pose, target, PASSES[-1].fit, s).pose
        true = bent(body.V, angle)
        before, after = (np.linalg.norm(shape(body, p)[0] - true, axis=1).mean() for p in (pose, again))
        assert after < 1.05 * before
        outer = body.g[:, 2] > 2.5
        turn = np.arctan2(again.rotation[outer, 2, 1], again.rotation[outer, 1, 1]).mean()
        assert turn == pytest.approx(angle, rel=0.1)


def test_a_limb_that_turned_is_rigid_and_loose_at_its_ends(body):
    s = np.full(len(body.edge), 0.5)
    limb = np.where(body.g[:, 2] > 0, 3, -1)
    ends = limb[body.edge]
    found = loose_limb_ends(body, s, limb)
    assert (found[(ends == 3).all(axis=1)] == 1.0).all()
    assert (found[(ends == -1).all(axis=1)] == 0.5).all()
    assert (found[ends[:, 0] != ends[:, 1]] == SETTINGS.limb_ends * 0.5).all()
    np.testing.assert_array_equal(loose_limb_ends(body, s, np.full(len(limb), -1)), s)


def test_edges_between_two_clusters_are_loosened_and_no_others(body):
    s = np.full(len(body.edge), 0.5)
    cluster = (body.g[:, 2] > 0).astype(np.int64)
    apart = cluster[body.edge[:, 0]] != cluster[body.edge[:, 1]]
    found = loose_between_clusters(body, s, cluster)
    assert (found[apart] == SETTINGS.between_clusters * 0.5).all()
    assert (found[~apart] == 0.5).all()
