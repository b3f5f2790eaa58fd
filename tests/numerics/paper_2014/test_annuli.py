"""Laws of self-, cast- and merge-error."""

import numpy as np
import pytest
from articulated import chain, swings

from kinetree.tasks.numerics.paper_2014.annuli import (
    annulus_clusters,
    frame_motion,
    least_rigid,
    merge_error,
    residual_sums,
    self_errors,
)

BODY = chain((0.0,), swings(12, 2, degrees=60.0, axes=1))
ANNULUS = np.minimum(((BODY.V[:, 2] + 5.0) / 0.8).astype(int), 11)
FLOOR = 1e-4


def annuli(x, of_vertex=ANNULUS):
    return [x[:, of_vertex == k] for k in range(of_vertex.max() + 1)]


def clusters_at(threshold, annuli):
    return annulus_clusters(annuli, [threshold], FLOOR)[0]


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
    clusters = clusters_at(1.1, annuli(BODY.V + np.arange(4.0)[:, None, None]))
    assert (clusters.cluster == 0).all()
    assert clusters.rigid.all()
    np.testing.assert_array_equal(clusters.merge_error, 1.0)


def test_two_links_are_two_rigid_areas_parted_by_one_annulus_at_the_joint():
    clusters = clusters_at(1.5, annuli(BODY.x))
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
    assert clusters_at(1.1, annuli(BODY.x[:1])).rigid.all()


def test_rigid_annuli_with_different_motions_stay_single():
    rng = np.random.default_rng(0)
    shape = rng.normal(0, 1, (8, 3))
    resting = [np.broadcast_to(shape + [0, 0, k], (6, 8, 3)) for k in range(2)]
    leaving = [shape + [0, 0, 2 + k] + np.cumsum(rng.normal(0, 1, (6, 1, 3)), axis=0) for k in range(3)]
    clusters = clusters_at(1.2, [*resting, *leaving])
    assert clusters.rigid.tolist() == [True, True, False, False, False]
    assert len(np.unique(clusters.cluster)) == 4


def test_no_annuli_no_clusters():
    assert len(clusters_at(1.2, []).cluster) == 0


def test_clusters_at_several_thresholds_are_those_at_each():
    x = BODY.x + np.random.default_rng(1).normal(0.0, 0.05, BODY.x.shape)
    for threshold, several in zip((1.05, 1.3, 3.0), annulus_clusters(annuli(x), [1.05, 1.3, 3.0], FLOOR), strict=True):
        alone = clusters_at(threshold, annuli(x))
        assert several.cluster.tolist() == alone.cluster.tolist()
        assert several.merge_error.tolist() == alone.merge_error.tolist()


def test_self_error_is_large_where_an_annulus_turns_against_itself_and_nothing_on_rigid_ones():
    error = self_errors(annuli(BODY.x))
    across = [k for k in range(12) if len(np.unique(BODY.label[k == ANNULUS])) > 1]
    assert int(error.argmax()) in across
    assert np.delete(error, across).max() < 1e-9
    assert self_errors(annuli(BODY.x[:1])).tolist() == [0.0] * 12


@pytest.mark.parametrize("share", [0.1, 0.3, 0.5, 0.7, 0.9])
def test_a_joint_is_the_annulus_that_it_crosses_wherever_in_it(share):
    """A tube bent at height 0 with the joint at this share of an annulus of width 1, counted from the leaf below."""
    angle = np.linspace(0.0, 2.0 * np.pi, 16, endpoint=False)
    height = np.arange(-4.95, 5.0, 0.1)
    V = np.array([(np.cos(a), np.sin(a), h) for h in height for a in angle])
    x = np.repeat(V[None], 6, axis=0)
    upper = V[:, 2] > 0.0
    for t, turn in enumerate(np.radians([0.0, 25.0, 5.0, 30.0, 10.0, 40.0])):
        R = np.array([[1.0, 0.0, 0.0], [0.0, np.cos(turn), -np.sin(turn)], [0.0, np.sin(turn), np.cos(turn)]])
        x[t, upper] = V[upper] @ R.T
    rings = annuli(x, np.floor(V[:, 2] + share + 5.0).astype(int))
    rigid = least_rigid(clusters_at(1.3, rings).rigid, self_errors(rings))
    assert np.flatnonzero(~rigid).tolist() == [5]


def test_joint_moves_to_the_annulus_before_it_if_that_is_less_rigid():
    assert least_rigid(np.array([True, True, True, False, True, True]), np.array([0, 0, 9, 1, 0, 0.0])).tolist() == [
        True, True, False, True, True, True,
    ]  # fmt: skip


def test_joints_stay_where_nothing_is_less_rigid_at_the_leaf_and_at_the_end():
    still = np.zeros(5)
    for rigid in ([True, False, True, True, True], [True, True, True, True, False], [True] * 5, [False] * 5, []):
        error = np.array([9.0, 8.0, 7.0, 6.0, 0.0])[: len(rigid)]
        assert least_rigid(np.array(rigid, bool), error).tolist() == rigid
        assert least_rigid(np.array(rigid, bool), still[: len(rigid)]).tolist() == rigid
    assert least_rigid(np.array([True, True, False, False, True]), np.array([0, 9, 9, 1, 0.0])).tolist() == [
        True, False, False, True, True,
    ]  # fmt: skip
