"""Laws of self-, cast- and merge-error."""

import numpy as np
import pytest
from articulated import chain, swings

from kinetree.tasks.numerics.paper_2014.annuli import annulus_clusters, frame_motion, merge_error, residual_sums

BODY = chain((0.0,), swings(12, 2, degrees=60.0, axes=1))
ANNULUS = np.minimum(((BODY.V[:, 2] + 5.0) / 0.8).astype(int), 11)
FLOOR = 1e-4


def annuli(x, of_vertex=ANNULUS):
    return [x[:, of_vertex == k] for k in range(of_vertex.max() + 1)]


def test_motion_of_a_rigid_part_is_found_and_leaves_no_error():
    part = BODY.x[:, BODY.label == 1]
    motion = frame_motion(part)
    assert residual_sums(part, motion).max() < 1e-9
    rotation = BODY.R[1:, 1] @ BODY.R[:-1, 1].transpose(0, 2, 1)
    np.testing.assert_allclose(motion.R, rotation, atol=1e-9)


def test_motion_of_a_flat_part_is_a_rotation_and_no_mirror():
    flat = BODY.x[:, :3].copy()
    assert np.linalg.det(frame_motion(flat).R) == pytest.approx(1.0)


def test_rigid_body_is_one_cluster_without_error():
    clusters = annulus_clusters(annuli(BODY.V + np.arange(4.0)[:, None, None]), 1.1, FLOOR)
    assert (clusters.cluster == 0).all()
    assert clusters.rigid.all()
    np.testing.assert_array_equal(clusters.merge_error, 1.0)


def test_two_links_are_two_rigid_areas_parted_by_one_annulus_at_the_joint():
    clusters = annulus_clusters(annuli(BODY.x), 1.5, FLOOR)
    joint = np.flatnonzero(~clusters.rigid)
    assert len(joint) == 1
    assert len(np.unique(clusters.cluster)) == 3
    assert abs(BODY.V[joint[0] == ANNULUS, 2].mean()) < 0.9


def test_merge_error_is_one_for_an_annulus_that_moves_along_and_large_for_one_that_turns_away():
    noisy = BODY.x + np.random.default_rng(0).normal(0.0, 0.02, BODY.x.shape)
    low, adjacent, high = (noisy[:, k == ANNULUS] for k in (1, 2, 9))
    assert merge_error(adjacent, frame_motion(low), FLOOR) == pytest.approx(1.0, abs=0.1)
    assert merge_error(high, frame_motion(low), FLOOR) > 10.0


def test_errors_below_the_floor_are_none():
    x = BODY.V + np.random.default_rng(0).normal(0.0, 1e-6, BODY.x.shape)
    assert merge_error(x[:, ANNULUS == 5], frame_motion(x[:, ANNULUS == 4]), FLOOR) == 1.0


def test_one_frame_shows_no_joint():
    assert annulus_clusters(annuli(BODY.x[:1]), 1.1, FLOOR).rigid.all()


def test_rigid_annuli_with_different_motions_stay_single():
    rng = np.random.default_rng(0)
    shape = rng.normal(0, 1, (8, 3))
    resting = [np.broadcast_to(shape + [0, 0, k], (6, 8, 3)) for k in range(2)]
    leaving = [shape + [0, 0, 2 + k] + np.cumsum(rng.normal(0, 1, (6, 1, 3)), axis=0) for k in range(3)]
    clusters = annulus_clusters([*resting, *leaving], 1.2, FLOOR)
    assert clusters.rigid.tolist() == [True, True, False, False, False]
    assert len(np.unique(clusters.cluster)) == 4


def test_no_annuli_no_clusters():
    assert len(annulus_clusters([], 1.2, FLOOR).cluster) == 0
