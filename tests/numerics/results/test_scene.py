"""Laws of what a page is given to draw."""

import numpy as np
import pytest
from shapes import sphere

from kinetree.tasks.numerics.results.scene import Lattice, shades, spread


def test_lattice_is_off_by_at_most_half_a_step():
    X = np.random.default_rng(0).normal(size=(500, 3)) * [1, 20, 300]
    lattice = Lattice.around(X.min(axis=0), X.max(axis=0))
    assert np.abs(lattice.low + lattice.scale * lattice.levels(X).astype(float) - X).max() <= 0.5 * lattice.scale * (1 + 1e-9)


def test_lattice_of_a_single_point_is_that_point():
    lattice = Lattice.around(np.ones(3), np.ones(3))
    assert (lattice.levels(np.ones((4, 3))) == 0).all()


@pytest.mark.parametrize(("count", "limit"), [(1, 5), (5, 5), (100, 7), (3, 1)])
def test_spread_keeps_the_ends_and_the_limit(count, limit):
    found = spread(count, limit)
    assert len(found) == min(count, limit)
    assert found[0] == 0
    assert limit == 1 or found[-1] == count - 1


def test_parts_that_touch_have_other_colours():
    V, F = sphere(3)
    label = np.digitize(V[:, 2], np.linspace(-0.9, 0.9, 9))
    found = shades(label, F, 3)
    sides = label[F]
    for a, b in ((0, 1), (1, 2)):
        other = sides[:, a] != sides[:, b]
        assert (found[sides[other, a]] != found[sides[other, b]]).all()


def test_surface_without_parts_has_no_colours():
    _, F = sphere(1)
    assert len(shades(np.full(F.max() + 1, -1), F, 8)) == 0
