"""Quantised positions, a choice of frames and colours of parts."""

import numpy as np
import pytest
from shapes import sphere

from kinetree.tasks.numerics.results.scene import Lattice, evenly_spread, part_colouring


def test_lattice_point_is_at_most_half_a_step_away():
    X = np.random.default_rng(0).normal(size=(500, 3)) * [1, 20, 300]
    lattice = Lattice.around(X.min(axis=0), X.max(axis=0))
    assert np.abs(lattice.low + lattice.scale * lattice.levels(X).astype(float) - X).max() <= 0.5 * lattice.scale * (1 + 1e-9)


def test_lattice_of_a_single_point_is_that_point():
    lattice = Lattice.around(np.ones(3), np.ones(3))
    assert (lattice.levels(np.ones((4, 3))) == 0).all()


@pytest.mark.parametrize(("count", "limit"), [(1, 5), (5, 5), (100, 7), (3, 1)])
def test_spread_numbers_include_both_ends_and_respect_the_limit(count, limit):
    result = evenly_spread(count, limit)
    assert len(result) == min(count, limit)
    assert result[0] == 0
    assert limit == 1 or result[-1] == count - 1


def test_parts_that_touch_have_different_colours():
    V, F = sphere(3)
    label = np.digitize(V[:, 2], np.linspace(-0.9, 0.9, 9))
    result = part_colouring(label, F, 3)
    sides = label[F]
    for a, b in ((0, 1), (1, 2)):
        other = sides[:, a] != sides[:, b]
        assert (result[sides[other, a]] != result[sides[other, b]]).all()


def test_surface_without_parts_has_no_colours():
    _, F = sphere(1)
    assert len(part_colouring(np.full(F.max() + 1, -1), F, 8)) == 0
