"""Laws of a distance between trees, and trees whose distance is counted by hand."""

import networkx as nx
import pytest

from kinetree.tasks.numerics.results.evaluation.tree_edit import contracted_tree, remaining_ancestors, tree_edit_distance

PATH = (-1, 0, 1, 2, 3)
STAR = (-1, 0, 0, 0, 0)
HUMAN = (-1, 0, 1, 0, 3, 0, 5, 6, 0, 8, 9, 0, 11)


def rooted_elsewhere(parents, root):
    """The same tree as parents under another root, its joints numbered as the walk meets them."""
    graph = nx.Graph([(p, j) for j, p in enumerate(parents) if p >= 0])
    graph.add_node(root)
    order = list(nx.dfs_preorder_nodes(graph, root))
    above = {child: parent for parent, child in nx.bfs_edges(graph, root)}
    return tuple(-1 if j == root else order.index(above[j]) for j in order)


@pytest.mark.parametrize("tree", [(-1,), PATH, STAR, HUMAN])
def test_tree_is_at_no_distance_from_itself_whatever_its_root_and_order(tree):
    for root in range(len(tree)):
        assert tree_edit_distance(tree, rooted_elsewhere(tree, root)) == 0


def test_distance_is_symmetric():
    assert tree_edit_distance(PATH, HUMAN) == tree_edit_distance(HUMAN, PATH)
    assert tree_edit_distance(STAR, PATH) == tree_edit_distance(PATH, STAR)


@pytest.mark.parametrize("cut", range(1, 13))
def test_joint_less_is_one_edit(cut):
    remains = [j != cut for j in range(13)]
    assert tree_edit_distance(HUMAN, contracted_tree(HUMAN, remains)) == 1


@pytest.mark.parametrize("end", range(13))
def test_leaf_more_is_one_edit(end):
    assert tree_edit_distance(HUMAN, (*HUMAN, end)) == 1


def test_path_becomes_a_star_by_moving_two_of_its_joints():
    """Five joints in a row, or four around one: a row of three is in both, so two are deleted and two inserted."""
    assert tree_edit_distance(PATH, STAR) == 4


def test_nothing_is_as_far_from_a_tree_as_it_has_joints():
    assert tree_edit_distance((), HUMAN) == 13
    assert tree_edit_distance((-1,), HUMAN) == 12


def test_trees_with_the_same_joints_at_every_depth_are_told_apart():
    """Two joints below the root, three below these: two and one, or three and none."""
    assert tree_edit_distance((-1, 0, 0, 1, 1, 2), (-1, 0, 0, 1, 1, 1)) > 0


def test_long_chain_is_no_trouble():
    chain = tuple(range(-1, 29))
    assert tree_edit_distance(chain, chain[:-2]) == 2


def test_contraction_hangs_joints_on_their_nearest_kept_ancestor():
    assert contracted_tree(PATH, [True, False, True, False, True]) == [-1, 0, 1]
    assert contracted_tree((1, -1, 0), [True, True, False]) == [1, -1]


def test_kept_ancestor_of_a_kept_joint_is_itself():
    assert remaining_ancestors(PATH, [True, False, True, False, True]) == [0, 0, 2, 2, 4]
    assert remaining_ancestors(PATH, [False, True, False, False, False]) == [-1, 1, 1, 1, 1]
