"""Bones that meet at one joint and move as one rigid group or independently."""

import numpy as np

from kinetree.tasks.numerics.results.evaluation.split_joints import rigid_groups, split_joints

T = np.linspace(0, 1, 12)
PARENTS = (-1, 0, 1, 1, 1)
"""A root, a joint on it, and three bones that end beyond the joint."""


def turning(*amplitudes):
    """The three ends turn in their plane about the joint, each by its own amplitude in radians."""
    Y = np.zeros((12, 5, 3))
    Y[:, 1] = [0, 0, 1]
    for k, amplitude in enumerate(amplitudes):
        angle = 2.0 * k + amplitude * T
        Y[:, 2 + k] = Y[:, 1] + np.stack([np.cos(angle), np.sin(angle), 0 * T], axis=1)
    return Y


def test_joint_that_carries_one_rigid_group_is_not_split():
    tree = split_joints(turning(1, 1, 1), PARENTS, [False, True, False, False, False], 2.0)
    assert tree.parents == list(PARENTS)
    assert tree.origin.tolist() == [0, 1, 2, 3, 4]
    assert tree.scored.tolist() == [False, True, False, False, False]


def test_every_further_group_gets_a_joint_at_the_same_place():
    tree = split_joints(turning(1, 0, -1), PARENTS, [False, True, False, False, False], 2.0)
    assert tree.origin.tolist() == [0, 1, 2, 3, 4, 1, 1]
    assert tree.parents == [-1, 0, 1, 5, 6, 0, 0]
    assert tree.scored.tolist() == [False, True, False, False, False, False, False]


def test_two_children_that_move_together_share_one_joint():
    tree = split_joints(turning(1, 0, 1), PARENTS, [False] * 5, 2.0)
    assert tree.parents == [-1, 0, 1, 5, 1, 0]


def test_score_of_a_split_root_goes_to_its_first_added_joint():
    tree = split_joints(turning(1, 0, -1)[:, 1:], (-1, 0, 0, 0), [True, False, False, False], 2.0)
    assert tree.parents == [-1, 0, 4, 5, 0, 0]
    assert tree.scored.tolist() == [False, False, False, False, True, False]


def test_parent_of_an_added_joint_is_the_parent_of_its_joint_after_splitting():
    """The root's second group has a joint that is split too: the parent of both its joints is the root's added joint."""
    Y = np.concatenate([turning(1, 0, -1), np.zeros((12, 1, 3))], axis=1)
    Y[:, 5] = [0, 0, -1] + 0.5 * np.stack([np.sin(9 * T), 0 * T, np.cos(9 * T)], axis=1)
    tree = split_joints(Y, (-1, 0, 1, 1, 1, 0), [False] * 6, 2.0)
    assert tree.origin[6:].tolist() == [0, 1, 1]
    assert tree.parents == [-1, 0, 1, 7, 8, 6, 0, 0, 0]
    swapped = split_joints(Y[:, [0, 5, 2, 3, 4, 1]], (-1, 0, 5, 5, 5, 0), [False] * 6, 2.0)
    assert swapped.parents == [-1, 0, 5, 7, 8, 6, 0, 6, 6]


def test_children_that_keep_their_distance_form_a_group():
    assert rigid_groups(turning(1, 0, 1), [2, 3, 4], 0.01) == [[2, 4], [3]]
    assert rigid_groups(turning(1, 0, 1), [], 0.01) == []
    assert rigid_groups(turning(1, 0, 1), [2, 3, 4], 9.0) == [[2, 3, 4]]
