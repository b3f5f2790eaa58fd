"""Laws of the matching: of the same joints in any order, with one moved, one missing, one too many."""

import numpy as np
import pytest

from kinetree.tasks.numerics.results.evaluation.matching import assignment, joint_errors, matching, mean_distances

RNG = np.random.default_rng(3)
Y = RNG.uniform(0, 100, size=(7, 9, 3))
ALL = np.ones(9, bool)


def matched(X, limit=5.0, scored=ALL, allowed=None, spurious=None):
    n = X.shape[1]
    return matching(
        X, Y,
        np.ones((n, 9), bool) if allowed is None else allowed,
        scored=scored,
        can_be_spurious=np.ones(n, bool) if spurious is None else spurious,
        limit=limit,
    )  # fmt: skip


def test_every_joint_of_the_truth_itself_is_found_without_error():
    result = matched(Y)
    assert result.partner.tolist() == list(range(9))
    assert not len(result.spurious)
    assert np.array_equal(joint_errors(Y, Y, result.partner), np.zeros((7, 9)))


def test_order_of_the_joints_does_not_matter():
    order = RNG.permutation(9)
    result = matched(Y[:, order])
    assert np.array_equal(order[result.partner], np.arange(9))


def test_error_of_a_moved_joint_is_its_displacement_in_every_frame():
    X = Y.copy()
    X[:, 4] += [0.0, 3.0, 4.0]
    result = matched(X, limit=6.0)
    error = joint_errors(X, Y, result.partner)
    assert error[:, 4] == pytest.approx(np.full(7, 5.0))
    assert not np.delete(error, 4, axis=1).any()


def test_joint_that_is_moved_too_far_is_missing_and_spurious_and_leaves_the_others_alone():
    X = Y.copy()
    X[:, 4] += 1e6
    result = matched(X)
    assert result.partner.tolist() == [0, 1, 2, 3, -1, 5, 6, 7, 8]
    assert result.spurious.tolist() == [4]
    assert np.isnan(joint_errors(X, Y, result.partner)[:, 4]).all()


def test_far_joint_does_not_push_its_neighbours_out_of_their_places():
    """Three joints in a row, the first missed: the plain sum of distances would shift both others by one."""
    true = np.array([[[0.0, 0, 0], [4.0, 0, 0], [8.0, 0, 0]]])
    X = np.array([[[4.0, 0, 0], [8.0, 0, 0], [500.0, 0, 0]]])
    result = matching(X, true, np.ones((3, 3), bool), scored=np.ones(3, bool), can_be_spurious=np.ones(3, bool), limit=5.0)
    assert result.partner.tolist() == [-1, 0, 1]
    assert result.nearest == pytest.approx([4.0, 0.0, 0.0])


def test_two_joints_beside_one_true_joint_are_one_found_and_one_spurious():
    X = np.concatenate([Y, Y[:, :1] + 0.5], axis=1)
    result = matched(X)
    assert result.partner.tolist() == list(range(9))
    assert result.spurious.tolist() == [9]


def test_true_joint_that_is_not_scored_is_neither_missing_nor_spurious_but_takes_no_partner_from_one_that_is():
    scored = ALL.copy()
    scored[2] = False
    assert matched(np.delete(Y, 2, axis=1), scored=scored).spurious.tolist() == []
    assert matched(Y, scored=scored).spurious.tolist() == []
    near = Y.copy()
    near[:, 2] = near[:, 3] + 0.1
    result = matching(
        near[:, [3]] + 0.1, near, np.ones((1, 9), bool), scored=scored, can_be_spurious=np.ones(1, bool), limit=5.0
    )
    assert result.partner.tolist() == [-1, -1, -1, 0, -1, -1, -1, -1, -1]


def test_forbidden_pair_is_not_matched_and_a_root_is_never_spurious():
    allowed = ~np.eye(9, dtype=bool)
    spurious = ALL.copy()
    spurious[1] = False
    result = matched(Y, allowed=allowed, spurious=spurious)
    assert (result.partner == -1).all()
    assert result.spurious.tolist() == [0, 2, 3, 4, 5, 6, 7, 8]


def test_nothing_found_leaves_everything_missing():
    result = matched(np.zeros((7, 0, 3)))
    assert (result.partner == -1).all()
    assert np.isinf(result.nearest).all()


def test_mean_distances_are_symmetric_and_averaged_over_frames():
    X = RNG.uniform(size=(7, 4, 3))
    assert np.allclose(mean_distances(X, Y), mean_distances(Y, X).T)
    step = np.array([[[0.0, 0, 0]], [[3.0, 4, 0]]])
    assert mean_distances(step, np.zeros((2, 1, 3))).item() == pytest.approx(2.5)


def test_assignment_prefers_one_exact_pair_to_two_at_the_limit():
    assert assignment(np.array([[0.0, 4.5], [4.5, 9.0]]), 5.0) == [(0, 0)]
    assert assignment(np.zeros((0, 3)), 1.0) == []
