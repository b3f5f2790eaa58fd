"""Laws of the tree of joints and rigid parts."""

import numpy as np

from kinetree.tasks.numerics.paper_2014.joint_tree import joint_tree


def adjacency(*pairs, parts, areas):
    out = np.zeros((parts, areas), bool)
    for part, area in pairs:
        out[part, area] = True
    return out


def test_root_of_a_chain_is_its_largest_part():
    of_part = adjacency((0, 1), (1, 1), (1, 3), (2, 3), parts=3, areas=5)
    tree = joint_tree(np.array([[1, 3]]), np.array([1]), of_part, np.ones(5), np.array([1.0, 3.0, 1.0]))
    assert tree.joint.tolist() == [-1, 1, 3]
    assert tree.part.tolist() == [1, 0, 2]
    assert tree.parents.tolist() == [-1, 0, 0]


def test_joint_beyond_which_there_are_two_parts_has_a_node_for_each():
    of_part = adjacency((0, 3), (1, 3), (2, 3), parts=3, areas=4)
    tree = joint_tree(np.zeros((0, 2), int), np.zeros(0, int), of_part, np.ones(4), np.array([9.0, 1.0, 1.0]))
    assert tree.joint.tolist() == [-1, 3, 3]
    assert tree.part.tolist() == [0, 1, 2]


def test_joint_beyond_which_there_is_no_part_has_a_node_of_its_own():
    of_part = adjacency((0, 1), parts=1, areas=3)
    tree = joint_tree(np.array([[1, 2]]), np.array([-1]), of_part, np.ones(3), np.array([9.0]))
    assert tree.joint.tolist() == [-1, 1, 2]
    assert tree.part.tolist() == [0, -1, -1]
    assert tree.parents.tolist() == [-1, 0, 1]


def test_ring_of_parts_is_cut_once():
    of_part = adjacency((0, 0), (0, 1), (1, 0), (1, 1), parts=2, areas=2)
    tree = joint_tree(np.array([[0, 1]]), np.array([0]), of_part, np.ones(2), np.array([9.0, 1.0]))
    assert sorted(tree.joint.tolist()) == [-1, 0, 1]
    assert sorted(tree.part.tolist()) == [-1, 0, 1]


def test_body_without_joints_is_a_root():
    tree = joint_tree(np.zeros((0, 2), int), np.zeros(0, int), np.zeros((1, 1), bool), np.ones(1), np.ones(1))
    assert (tree.joint.tolist(), tree.part.tolist(), tree.parents.tolist()) == ([-1], [0], [-1])
    tree = joint_tree(np.zeros((0, 2), int), np.zeros(0, int), np.zeros((0, 1), bool), np.ones(1), np.zeros(0))
    assert tree.parents.tolist() == [-1]
