"""Chamfer distances and joint overlap on skeletons whose answers are counted by hand."""

import numpy as np
import pytest

from kinetree.tasks.numerics.results.evaluation.rignet import chamfer, overlap

RNG = np.random.default_rng(5)
TREE = (-1, 0, 1, 1, 3)
X = RNG.uniform(size=(3, 5, 3))
Y = RNG.uniform(size=(3, 5, 3))


def test_skeleton_is_at_no_distance_from_itself():
    assert chamfer(X, TREE, X, TREE, 1.0) == pytest.approx((0.0, 0.0, 0.0), abs=1e-12)
    assert overlap(X, X, np.full(5, 1e-9)) == (1.0, 1.0, 1.0)


def test_distances_are_symmetric():
    assert chamfer(X, TREE, Y, TREE, 1.0) == pytest.approx(chamfer(Y, TREE, X, TREE, 1.0))


def test_scale_changes_nothing_and_the_order_of_joints_neither():
    assert chamfer(7 * X, TREE, 7 * Y, TREE, 7.0) == pytest.approx(chamfer(X, TREE, Y, TREE, 1.0))
    order = [0, 1, 3, 2, 4]
    assert chamfer(X[:, order], (-1, 0, 1, 1, 2), Y, TREE, 1.0) == pytest.approx(chamfer(X, TREE, Y, TREE, 1.0))


def test_parallel_bones_are_apart_by_their_distance_whatever_is_measured():
    bone = np.array([[[0.0, 0, 0], [1.0, 0, 0]]])
    assert chamfer(bone, (-1, 0), bone + [0, 0.25, 0], (-1, 0), 1.0) == pytest.approx((25.0, 25.0, 25.0))


def test_joint_in_the_middle_of_a_bone_is_far_from_its_joints_and_on_it():
    """One bone of length 1, once with a joint in its middle: joints are (0, 0, ½) apart one way, bones nowhere."""
    bone = np.array([[[0.0, 0, 0], [1.0, 0, 0]]])
    split = np.array([[[0.0, 0, 0], [0.5, 0, 0], [1.0, 0, 0]]])
    j2j, j2b, b2b = chamfer(split, (-1, 0, 1), bone, (-1, 0), 1.0)
    assert j2j == pytest.approx(100 * (0.5 / 3) / 2)
    assert (j2b, b2b) == pytest.approx((0.0, 0.0), abs=1e-9)


def test_skeleton_of_one_joint_is_measured_too():
    one = np.zeros((1, 1, 3))
    bone = np.array([[[1.0, 0, 0], [2.0, 0, 0]]])
    j2j, j2b, _ = chamfer(one, (-1,), bone, (-1, 0), 1.0)
    assert j2j == pytest.approx(100 * (1.0 + 1.5) / 2)
    assert j2b == pytest.approx(100 * (1.0 + 1.5) / 2)
    assert overlap(one, bone, np.ones(2)) == (0.0, 0.0, 0.0)


def test_overlap_counts_pairs_nearer_than_each_joints_own_tolerance():
    """Pairs are 0.1 apart; two of three true joints allow that; a fourth joint of the result is far from all of them."""
    true = np.array([[[0.0, 0, 0], [1.0, 0, 0], [2.0, 0, 0]]])
    joints = np.concatenate([true + [0, 0.1, 0], [[[9.0, 0, 0]]]], axis=1)
    assert overlap(joints, true, np.array([0.2, 0.05, 0.2])) == pytest.approx((4 / 7, 2 / 4, 2 / 3))
