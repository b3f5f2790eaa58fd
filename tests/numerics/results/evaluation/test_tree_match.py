"""Edits between trees of known joints, counted by hand."""

import pytest

from kinetree.tasks.numerics.results.evaluation.tree_edit import contracted_tree, tree_edit_distance
from kinetree.tasks.numerics.results.evaluation.tree_match import separations, tree_match_distance

DOG = (-1, 0, 1, 1, 1, 0, 0, 0, 2, 3)
"""A pelvis with the joint of the chest (1), tail and hind legs (5, 6, 7); on the chest a neck and two legs that bend (2, 3)."""
SAME = [(j, j) for j in range(1, 10)]


def without(parents, cut):
    """The tree with one joint less, and its pairs with the tree as it was."""
    remains = [j != cut for j in range(len(parents))]
    stay = [j for j in range(len(parents)) if j != cut]
    return contracted_tree(parents, remains), [(k, j) for k, j in enumerate(stay) if parents[j] >= 0]


def distance(parents, others, pairs, place=None):
    return tree_match_distance(parents, others, pairs, place or list(range(len(others))))


def test_tree_is_at_no_distance_from_itself():
    assert distance(DOG, DOG, SAME) == 0


def test_root_may_be_any_part():
    """The same dog told from its chest: joint 1 is still between the two, its parent is the other part."""
    chest = (-1, 0, 0, 0, 0, 1, 1, 1, 2, 3)
    assert distance(chest, DOG, SAME) == 0


@pytest.mark.parametrize("cut", range(1, 10))
def test_joint_less_is_one_edit_also_where_it_divides_a_trunk(cut):
    less, pairs = without(DOG, cut)
    assert distance(less, DOG, pairs) == 1
    assert distance(DOG, less, [(j, i) for i, j in pairs]) == 1


def test_distance_that_keeps_branches_separate_counts_a_trunk_in_two_as_more():
    less, _ = without(DOG, 1)
    assert tree_edit_distance(less, DOG) > 1


def test_joint_that_was_matched_with_none_is_taken_out_and_another_put_in():
    assert distance(DOG, DOG, SAME[:-1]) == 2


def test_leg_that_hangs_on_the_wrong_part_is_taken_out_and_put_in():
    wrong = (-1, 0, 1, 1, 1, 0, 0, 1, 2, 3)
    assert distance(wrong, DOG, SAME) == 2


def test_joints_at_one_place_may_be_told_in_any_order():
    star = (-1, 0, 0, 0, 1, 2, 3)
    pairs = [(1, 2), (2, 3), (3, 1), (4, 4), (5, 5), (6, 6)]
    assert distance(star, star, pairs) > 0
    assert distance(star, star, pairs, place=[0, 9, 9, 9, 4, 5, 6]) == 0


def test_nothing_in_common_costs_all_joints_of_both():
    assert distance((-1, 0, 1), (-1, 0), []) == 3
    assert distance((-1,), (-1,), []) == 0


def test_middle_of_a_chain_separates_its_ends_and_a_star_nothing():
    chain = separations((-1, 0, 1, 2))
    assert chain[1, 2, 3]
    assert chain[3, 2, 1]
    assert chain[1:, 1:, 1:].sum() == 2
    assert not chain[:, 0].any()
    assert not separations((-1, 0, 0, 0))[1:, 1:, 1:].any()
