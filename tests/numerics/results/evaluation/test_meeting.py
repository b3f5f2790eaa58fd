"""Bones that meet at one place: moving as one, or each by itself."""

import numpy as np

from kinetree.tasks.numerics.results.evaluation.meeting import divided, rigid_pieces

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


def test_joint_that_carries_one_rigid_piece_stays_one():
    tree = divided(turning(1, 1, 1), PARENTS, [False, True, False, False, False], 2.0)
    assert tree.parents == list(PARENTS)
    assert tree.origin.tolist() == [0, 1, 2, 3, 4]
    assert tree.scored.tolist() == [False, True, False, False, False]


def test_every_further_piece_has_a_joint_of_its_own_beside_the_first():
    tree = divided(turning(1, 0, -1), PARENTS, [False, True, False, False, False], 2.0)
    assert tree.origin.tolist() == [0, 1, 2, 3, 4, 1, 1]
    assert tree.parents == [-1, 0, 1, 5, 6, 0, 0]
    assert tree.scored.tolist() == [False, True, False, False, False, False, False]


def test_two_that_move_together_share_one():
    tree = divided(turning(1, 0, 1), PARENTS, [False] * 5, 2.0)
    assert tree.parents == [-1, 0, 1, 5, 1, 0]


def test_root_whose_bones_part_hands_its_score_to_the_joint_beside_it():
    tree = divided(turning(1, 0, -1)[:, 1:], (-1, 0, 0, 0), [True, False, False, False], 2.0)
    assert tree.parents == [-1, 0, 4, 5, 0, 0]
    assert tree.scored.tolist() == [False, False, False, False, True, False]


def test_joint_beside_another_hangs_where_that_one_came_to_hang():
    """The root's second piece holds a joint that is divided too: both of its joints hang on the root's second."""
    Y = np.concatenate([turning(1, 0, -1), np.zeros((12, 1, 3))], axis=1)
    Y[:, 5] = [0, 0, -1] + 0.5 * np.stack([np.sin(9 * T), 0 * T, np.cos(9 * T)], axis=1)
    tree = divided(Y, (-1, 0, 1, 1, 1, 0), [False] * 6, 2.0)
    assert tree.origin[6:].tolist() == [0, 1, 1]
    assert tree.parents == [-1, 0, 1, 7, 8, 6, 0, 0, 0]
    swapped = divided(Y[:, [0, 5, 2, 3, 4, 1]], (-1, 0, 5, 5, 5, 0), [False] * 6, 2.0)
    assert swapped.parents == [-1, 0, 5, 7, 8, 6, 0, 6, 6]


def test_pieces_are_told_by_distances_that_stay():
    assert rigid_pieces(turning(1, 0, 1), [2, 3, 4], 0.01) == [[2, 4], [3]]
    assert rigid_pieces(turning(1, 0, 1), [], 0.01) == []
    assert rigid_pieces(turning(1, 0, 1), [2, 3, 4], 9.0) == [[2, 3, 4]]
