"""Laws of the tree of joints and rigid parts."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.sparse.csgraph import connected_components

from kinetree.tasks.numerics.paper_2014.bones import candidates
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


def test_joint_beyond_which_there_are_two_parts_is_one_node_with_the_larger_and_what_hangs_on_either():
    of_part = adjacency((0, 3), (1, 3), (2, 3), (1, 4), (2, 5), parts=3, areas=6)
    bone = np.array([[3, 4], [3, 5]])
    tree = joint_tree(bone, np.array([1, 2]), of_part, np.ones(6), np.array([9.0, 1.0, 2.0]))
    assert tree.joint.tolist() == [-1, 3, 4, 5]
    assert tree.part.tolist() == [0, 2, -1, -1]
    assert tree.parents.tolist() == [-1, 0, 1, 1]


@given(st.integers(1, 6), st.integers(0, 7), st.randoms(use_true_random=False))
def test_every_joint_is_one_node_whatever_touches_what(parts, joints, random):
    of_part = np.zeros((parts, parts + joints), bool)
    for area in range(parts, parts + joints):
        of_part[random.randrange(parts), area] = of_part[random.randrange(parts), area] = True
    part = np.r_[np.arange(parts), np.full(joints, -1)]
    adjacent = np.zeros((parts + joints, parts + joints), bool)
    adjacent[:parts] = of_part
    bone, bone_part = candidates(adjacent | adjacent.T, part)
    tree = joint_tree(bone, bone_part, of_part, np.ones(parts + joints), np.ones(parts))
    reached = connected_components(np.asarray(adjacent | adjacent.T))[1]
    within = [a for a in range(parts, parts + joints) if reached[a] == reached[tree.part[0]]]
    assert sorted(tree.joint[1:].tolist()) == within


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
