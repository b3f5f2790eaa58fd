"""Laws of nodes spread over a surface, on planes, tubes and spheres."""

import numpy as np
import pytest
from limbs import tube
from shapes import flat_grid, sphere, two_components

from kinetree.tasks.numerics.geometry.covering import covering, nearest_nodes
from kinetree.tasks.numerics.geometry.geodesic_distance import geodesic_distance
from kinetree.tasks.numerics.geometry.surface import Surface


def test_nodes_are_different_vertices_in_ascending_order():
    V, F = sphere(3)
    node = covering(Surface.of(V, F), np.ones(len(V)), 50)
    assert len(node) == 50
    assert (np.diff(node) > 0).all()


def test_no_two_nodes_are_nearer_than_the_largest_gap_they_leave():
    V, F = tube(around=32, along=64)
    surface = Surface.of(V, F)
    node = covering(surface, np.ones(len(V)), 40)
    distance = geodesic_distance(surface, node, exact=0.0)
    between = distance[:, node] + np.diag(np.full(40, np.inf))
    assert between.min() > 0.95 * distance.min(axis=0).max()


def test_where_half_the_spacing_is_wanted_gaps_are_half_as_wide():
    V, F = flat_grid(60, 60)
    surface = Surface.of(V, F)
    node = covering(surface, np.where(V[:, 0] < 30, 1.0, 0.5), 120)
    gap = geodesic_distance(surface, node).min(axis=0)
    wide, narrow = gap[V[:, 0] < 25].max(), gap[V[:, 0] > 35].max()
    assert narrow / wide == pytest.approx(0.5, abs=0.12)


def test_the_nearest_nodes_are_those_of_all_distances():
    V, F = tube(around=24, along=40)
    surface = Surface.of(V, F)
    node = covering(surface, np.ones(len(V)), 60)
    nearest, distance = nearest_nodes(surface, node, 5)
    every = geodesic_distance(surface, node, exact=0.0)
    np.testing.assert_allclose(distance, np.sort(every, axis=0)[:5].T, atol=1e-9)
    np.testing.assert_allclose(np.take_along_axis(every, nearest.T, axis=0).T, distance, atol=1e-9)


def test_a_vertex_has_no_more_neighbours_than_its_component_has_nodes():
    V, F = two_components(2)
    surface = Surface.of(V, F)
    node = covering(surface, np.ones(len(V)), 5)
    nearest, distance = nearest_nodes(surface, node, 5)
    first = np.arange(len(V)) < len(V) // 2
    mine = (node < len(V) // 2).sum()
    assert 0 < mine < 5
    np.testing.assert_array_equal((nearest[first] >= 0).sum(axis=1), mine)
    np.testing.assert_array_equal(np.isinf(distance), nearest < 0)


def test_more_nodes_than_vertices_are_all_vertices():
    V, F = sphere(1)
    np.testing.assert_array_equal(covering(Surface.of(V, F), np.ones(len(V)), 10**4), np.arange(len(V)))


def test_where_every_vertex_is_a_node_each_has_the_neighbours_it_wants():
    V, F = sphere(1)
    nearest, distance = nearest_nodes(Surface.of(V, F), np.arange(len(V)), 5)
    np.testing.assert_array_equal(nearest[:, 0], np.arange(len(V)))
    assert np.isfinite(distance).all()
