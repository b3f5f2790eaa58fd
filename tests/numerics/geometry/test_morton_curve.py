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


def test_the_order_is_that_of_sorting_by_the_interleaved_bits_of_the_cells():
    V = np.random.default_rng(2).normal(size=(500, 3))
    cell = np.minimum((V - V.min(axis=0)) / np.ptp(V) * 1024, 1023).astype(int)
    bits = ["".join(f"{c:010b}"[k] for k in range(10) for c in (z, y, x)) for x, y, z in cell.tolist()]
    assert morton_order(V).tolist() == sorted(range(len(V)), key=lambda i: (bits[i], i))


def test_one_far_point_that_puts_all_others_into_one_cell_costs_no_time():
    V = np.vstack([np.random.default_rng(3).normal(size=(40_000, 3)), [[1e9, 0.0, 0.0]]])
    sample = spread_along_curve(V, 100)
    np.testing.assert_array_equal(np.diff(V[sample, 0]) >= 0, True)
