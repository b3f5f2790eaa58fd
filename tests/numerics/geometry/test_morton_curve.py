"""Laws of the Morton curve."""

import numpy as np
from limbs import tube
from scipy.spatial import cKDTree
from shapes import flat_grid

from kinetree.tasks.numerics.geometry.morton_curve import morton_order, spread_along_curve


def test_along_the_curve_the_next_vertex_is_near():
    V = np.random.default_rng(0).permutation(flat_grid(32, 32)[0])
    order = morton_order(V)
    np.testing.assert_array_equal(np.sort(order), np.arange(len(V)))
    step = np.linalg.norm(np.diff(V[order], axis=0), axis=1)
    assert np.median(step) <= np.sqrt(2.0)
    assert step.mean() < 2.0


def test_a_mesh_without_vertices_has_an_order():
    assert len(morton_order(np.zeros((0, 3)))) == 0


def test_samples_spread_evenly_in_whatever_order_the_mesh_lists_its_vertices():
    V, _ = tube(around=40, along=80)
    order = np.random.default_rng(0).permutation(len(V))
    assert {tuple(x) for x in V[spread_along_curve(V, 300)]} == {tuple(x) for x in V[order][spread_along_curve(V[order], 300)]}
    assert cKDTree(V[spread_along_curve(V, 300)]).query(V)[0].max() < 1.5


def test_as_many_samples_as_vertices_are_all_of_them():
    V, _ = tube()
    np.testing.assert_array_equal(np.sort(spread_along_curve(V, 10**6)), np.arange(len(V)))
