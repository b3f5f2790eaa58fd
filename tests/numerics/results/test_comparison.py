"""Laws of pairing the joints of two skeletons."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinetree.tasks.numerics.results.comparison import allowed_distances, box_difference, mutual_nearest, pair_distances

RNG = np.random.default_rng(0)
X = RNG.uniform(size=(5, 6, 3))
ALL = np.ones((6, 6), dtype=bool)


@given(st.permutations(range(6)))
def test_a_permuted_skeleton_is_paired_joint_by_joint(order: list[int]) -> None:
    distance = allowed_distances(X, X[:, order], ALL)
    assert mutual_nearest(distance, 0.01) == [(i, order.index(i)) for i in range(6)]


@given(st.integers(0, 1000), st.floats(0.05, 1.0))
def test_pairs_do_not_depend_on_which_skeleton_is_first(seed: int, limit: float) -> None:
    Y = np.random.default_rng(seed).uniform(size=(5, 4, 3))
    distance = allowed_distances(X, Y, np.ones((6, 4), dtype=bool))
    one, two = mutual_nearest(distance, limit), mutual_nearest(distance.T, limit)
    assert sorted((j, i) for i, j in two) == one
    assert len({i for i, _ in one}) == len({j for _, j in one}) == len(one)


def test_pair_beyond_the_limit_is_none() -> None:
    distance = np.array([[0.2, 0.9], [0.8, 0.6]])
    assert mutual_nearest(distance, 0.5) == [(0, 0)]
    assert mutual_nearest(distance, 0.6) == [(0, 0), (1, 1)]


def test_joint_whose_nearest_has_a_nearer_one_has_no_partner() -> None:
    assert mutual_nearest(np.array([[0.1], [0.2]]), 1.0) == [(0, 0)]


def test_pairs_that_are_not_allowed_are_never_made() -> None:
    distance = allowed_distances(X, X, ~np.eye(6, dtype=bool))
    assert all(i != j for i, j in mutual_nearest(distance, 10.0))
    assert mutual_nearest(np.full((3, 2), np.inf), 1.0) == []


@pytest.mark.parametrize("shape", [(0, 3), (3, 0), (0, 0)])
def test_skeleton_without_joints_has_no_pairs(shape: tuple[int, int]) -> None:
    assert mutual_nearest(np.zeros(shape), 1.0) == []
    assert pair_distances(X, X, []).shape == (5, 0)


def test_distance_of_a_pair_is_that_of_every_frame() -> None:
    moved = X + np.arange(5)[:, None, None] * [0.0, 3.0, 4.0]
    np.testing.assert_allclose(pair_distances(X, moved, [(2, 2), (4, 4)]), 5.0 * np.arange(5)[:, None] * [1, 1], atol=1e-12)


def test_box_difference_is_a_share_of_the_size_and_symmetric() -> None:
    V = np.array([[0.0, 0, 0], [3, 4, 0]])
    assert box_difference(V, V) == 0.0
    assert box_difference(V, V + [0.5, 0, 0]) == pytest.approx(0.1)
    assert box_difference(V, 10 * V) == pytest.approx(box_difference(10 * V, V)) == pytest.approx(0.9)
