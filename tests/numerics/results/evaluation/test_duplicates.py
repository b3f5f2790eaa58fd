"""Laws of spurious joints: beside a true joint that is found, or where no joint is."""

import numpy as np

from kinetree.tasks.numerics.results.evaluation.duplicates import branching, duplicated

Y = np.array([[[0.0, 0, 0], [10, 0, 0], [20, 0, 0]], [[0.0, 0, 1], [10, 0, 1], [20, 0, 1]]])
FOUND = np.array([True, True, False])


def beside(*places):
    X = np.array(places, dtype=float)[None] + Y[:, :1]
    return duplicated(X, Y, np.arange(len(places)), FOUND, 1.5).tolist()


def test_a_joint_beside_one_that_is_found_is_its_duplicate_and_elsewhere_it_is_false():
    assert beside([0.5, 0, 0], [11, 1, 0], [5, 0, 0]) == [0, 1, -1]


def test_a_joint_beside_one_that_is_not_found_is_no_duplicate():
    assert beside([20, 0, 0]) == [-1]


def test_distance_counts_over_all_frames():
    X = Y[:, :1] + np.array([[[1.0, 0, 0]], [[4.0, 0, 0]]])
    assert duplicated(X, Y, np.array([0]), FOUND, 1.5).tolist() == [-1]
    assert duplicated(X, Y, np.array([0]), FOUND, 2.5).tolist() == [0]


def test_without_spurious_joints_or_joints_found_there_is_no_duplicate():
    assert duplicated(Y, Y, np.zeros(0, np.int64), FOUND, 1.0).tolist() == []
    assert duplicated(Y, Y, np.array([1]), np.zeros(3, bool), 1.0).tolist() == [-1]


def test_joints_that_several_bones_hang_on_branch():
    assert branching([-1, 0, 0, 1, 3, 3]).tolist() == [True, False, False, True, False, False]
