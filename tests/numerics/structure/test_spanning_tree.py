"""The spanning tree and its root."""

import networkx as nx
import numpy as np
import pytest

from kinetree.tasks.numerics.structure.spanning_tree import branch_area, rooted, spanning


@pytest.mark.parametrize("seed", range(5))
def test_spanning_tree_is_a_minimum_one(seed: int) -> None:
    rng = np.random.default_rng(seed)
    pair = np.array([(a, b) for a in range(8) for b in range(a + 1, 8)])
    cost = rng.uniform(size=len(pair))
    graph: nx.Graph[int] = nx.Graph()
    graph.add_weighted_edges_from((int(a), int(b), c) for (a, b), c in zip(pair, cost, strict=True))
    least = sum(d["weight"] for _, _, d in nx.minimum_spanning_edges(graph, data=True))
    kept = spanning(pair, cost, 8)
    assert len(kept) == 7
    assert cost[kept].sum() == pytest.approx(least)


def test_root_is_where_no_branch_is_heavier_than_half() -> None:
    pair = np.array([[0, 1], [1, 2], [2, 3], [3, 4]])
    tree = rooted(pair, np.arange(4), np.array([1.0, 1.0, 1.0, 1.5, 5.0]))
    assert tree.order.tolist() == [4, 3, 2, 1, 0]
    assert tree.parents.tolist() == [-1, 0, 1, 2, 3]
    assert tree.border.tolist() == [-1, 3, 2, 1, 0]
    assert branch_area(tree, np.array([1.0, 1.0, 1.0, 1.5, 5.0])).tolist() == [9.5, 4.5, 3.0, 2.0, 1.0]


def test_parts_that_meet_nothing_are_refused() -> None:
    with pytest.raises(ValueError, match="1 parts meet no other part"):
        rooted(np.array([[0, 1]]), np.array([0]), np.ones(3))
