"""Laws of loops and branches on graphs drawn by hand."""

import numpy as np
import pytest

from kinetree.tasks.numerics.paper_2009.graph_loops import (
    branch_degrees,
    branch_length,
    closing_edges,
    end_branches,
    path,
    pruned,
)

RING = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])
STAR = np.array([[0, 1], [0, 2], [0, 3], [3, 4]])


def test_ring_is_closed_by_its_lightest_edge() -> None:
    closing, reach = closing_edges(4, RING, np.array([4.0, 3.0, 1.0, 2.0]), np.array([0.0, 0.3, 0.5, 0.2]))
    assert closing.tolist() == [False, False, True, False]
    assert reach[2] == 0.5


def test_tree_has_no_closing_edge() -> None:
    assert not closing_edges(5, STAR, np.ones(4), np.arange(5.0))[0].any()


def test_path_leads_along_the_tree() -> None:
    tree = [[1, 2, 3], [0], [0], [0, 4], [3]]
    assert path(tree, 4, 1) == [1, 0, 3, 4]


def test_branches_without_an_end_hang_on_what_stays() -> None:
    assert pruned(5, STAR, np.array([1, 4]), np.ones(5)).tolist() == [0, 1, 0, 3, 4]


def test_loops_are_not_pruned() -> None:
    assert pruned(4, RING, np.zeros(0, np.int64), np.ones(4)).tolist() == [0, 1, 2, 3]


def test_degrees_and_branches_of_a_star() -> None:
    assert branch_degrees(5, STAR) == (3,)
    assert end_branches(5, STAR, np.array([4, 1, 2])).tolist() == [-1, 1, 2, 0, 0]


def test_legs_that_touch_along_their_length_have_short_branches() -> None:
    body, fork = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0]], [[0.0, 1.0, 0.0], [0.0, 0.0, 3.0]]
    fused = np.array([*body, *fork, [0.0, 0.0, 2.0], [0.0, 0.1, 3.0]])
    free = np.array([*body, *fork, [0.0, 0.0, 2.0], [0.0, 3.0, 0.0]])
    ends = np.array([1, 3, 5])
    one, other = np.array([[0, 1], [0, 4], [4, 3], [4, 5]]), np.array([[0, 1], [0, 4], [4, 3], [0, 5]])
    short, long = (branch_length(x, e, end_branches(6, e, ends), ends) for x, e in ((fused, one), (free, other)))
    assert long == pytest.approx((4.0 * 3.0 * 3.0) ** (1 / 3))
    assert short < 0.6 * long
    assert branch_length(free, other, end_branches(6, other, ends[:0]), ends[:0]) == 0.0
