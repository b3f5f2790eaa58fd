"""Rand index and overlap of parts: laws, and the example of a textbook."""

import numpy as np
import pytest

from kinetree.tasks.numerics.results.evaluation.parts import (
    adjusted_rand_index,
    contingency,
    leading_parts,
    mean_iou,
    rand_index,
)

RNG = np.random.default_rng(2)
LABEL = RNG.integers(0, 5, 300)
OTHER = RNG.integers(0, 3, 300)


def test_other_names_for_the_same_parts_change_nothing():
    table = contingency(LABEL, np.array([40, -7, 3, 0, 12])[LABEL])
    assert (rand_index(table), adjusted_rand_index(table), mean_iou(table)) == (1.0, 1.0, 1.0)


def test_both_indices_are_symmetric():
    table = contingency(LABEL, OTHER)
    assert rand_index(table) == pytest.approx(rand_index(table.T))
    assert adjusted_rand_index(table) == pytest.approx(adjusted_rand_index(table.T))


def test_chance_agrees_by_nothing_once_adjusted():
    assert adjusted_rand_index(contingency(LABEL, OTHER)) == pytest.approx(0.0, abs=0.02)


def test_pairs_counted_one_by_one_are_the_same():
    """Five points, a a b b b against x x x y y: all ten pairs."""
    a, b = np.array([0, 0, 1, 1, 1]), np.array([0, 0, 0, 1, 1])
    agree = sum((a[i] == a[j]) == (b[i] == b[j]) for i in range(5) for j in range(i))
    assert rand_index(contingency(a, b)) == pytest.approx(agree / 10)


def test_example_of_hubert_and_arabie():
    """Rows (1, 1, 0), (1, 2, 1), (0, 0, 4): 10 points, Rand index 32/45... adjusted (7 − 13·14/45) / (13.5 − 13·14/45)."""
    table = np.array([[1, 1, 0], [1, 2, 1], [0, 0, 4]])
    assert adjusted_rand_index(table) == pytest.approx((7 - 13 * 14 / 45) / (13.5 - 13 * 14 / 45))
    assert rand_index(table) == pytest.approx((45 - 13 - 14 + 2 * 7) / 45)


def test_one_part_where_there_are_two_overlaps_half_of_the_larger():
    table = contingency(np.zeros(10, int), np.array([0] * 6 + [1] * 4))
    assert mean_iou(table) == pytest.approx((0.6 + 0.0) / 2)
    assert adjusted_rand_index(table) == 0.0


def test_extra_part_does_not_help():
    halves = np.array([0] * 5 + [1] * 5)
    thirds = np.array([0] * 5 + [1] * 3 + [2] * 2)
    assert mean_iou(contingency(thirds, halves)) == pytest.approx((1.0 + 0.6) / 2)


def test_vertex_without_a_label_goes_with_what_it_follows_most():
    influence = np.array([[4, 5], [4, 5], [6, 4]])
    weight = np.array([[0.4, 0.6], [0.4, 0.6], [1.0, 0.0]])
    assert leading_parts(np.array([4, -1, -1]), influence, weight).tolist() == [4, 5, 6]
