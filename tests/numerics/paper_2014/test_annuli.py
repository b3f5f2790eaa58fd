"""Laws of self-, cast- and merge-error."""

import numpy as np
import pytest
from articulated import chain, swings

from kinetree.tasks.numerics.paper_2014.annuli import clustered, left, merge_error, steps

BODY = chain((0.0,), swings(12, 2, degrees=60.0, axes=1))
RING = np.minimum(((BODY.V[:, 2] + 5.0) / 0.8).astype(int), 11)
FLOOR = 1e-4


def rings(x, ring=RING):
    return [x[:, ring == k] for k in range(ring.max() + 1)]


def test_motion_of_a_rigid_part_is_found_and_leaves_nothing():
    part = BODY.x[:, BODY.label == 1]
    step = steps(part)
    assert left(part, step).max() < 1e-9
    turn = BODY.R[1:, 1] @ BODY.R[:-1, 1].transpose(0, 2, 1)
    np.testing.assert_allclose(step.R, turn, atol=1e-9)


def test_motion_of_a_flat_part_is_a_rotation_and_no_mirror():
    flat = BODY.x[:, :3].copy()
    assert np.linalg.det(steps(flat).R) == pytest.approx(1.0)


def test_rigid_body_is_one_cluster_without_error():
    found = clustered(rings(BODY.V + np.arange(4.0)[:, None, None]), 1.1, FLOOR)
    assert (found.cluster == 0).all()
    assert found.rigid.all()
    np.testing.assert_array_equal(found.merge, 1.0)


def test_two_links_are_two_rigid_areas_parted_by_one_annulus_at_the_joint():
    found = clustered(rings(BODY.x), 1.5, FLOOR)
    joint = np.flatnonzero(~found.rigid)
    assert len(joint) == 1
    assert len(np.unique(found.cluster)) == 3
    assert abs(BODY.V[joint[0] == RING, 2].mean()) < 0.9


def test_merge_error_is_one_for_what_moves_along_and_large_for_what_turns_away():
    noisy = BODY.x + np.random.default_rng(0).normal(0.0, 0.02, BODY.x.shape)
    low, next_to_it, high = (noisy[:, k == RING] for k in (1, 2, 9))
    assert merge_error(next_to_it, steps(low), FLOOR) == pytest.approx(1.0, abs=0.1)
    assert merge_error(high, steps(low), FLOOR) > 10.0


def test_errors_below_the_floor_are_none():
    x = BODY.V + np.random.default_rng(0).normal(0.0, 1e-6, BODY.x.shape)
    assert merge_error(x[:, RING == 5], steps(x[:, RING == 4]), FLOOR) == 1.0


def test_one_frame_shows_no_joint():
    assert clustered(rings(BODY.x[:1]), 1.1, FLOOR).rigid.all()


def test_rigid_annuli_that_go_different_ways_stay_by_themselves():
    rng = np.random.default_rng(0)
    shape = rng.normal(0, 1, (8, 3))
    still = [np.broadcast_to(shape + [0, 0, k], (6, 8, 3)) for k in range(2)]
    away = [shape + [0, 0, 2 + k] + np.cumsum(rng.normal(0, 1, (6, 1, 3)), axis=0) for k in range(3)]
    found = clustered([*still, *away], 1.2, FLOOR)
    assert found.rigid.tolist() == [True, True, False, False, False]
    assert len(np.unique(found.cluster)) == 4


def test_no_annuli_no_clusters():
    assert len(clustered([], 1.2, FLOOR).cluster) == 0
