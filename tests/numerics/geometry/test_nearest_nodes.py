"""Laws of the nearest nodes of every vertex, on tubes and spheres."""

import numpy as np
from limbs import tube
from shapes import sphere, two_components

from kinetree.tasks.numerics.geometry.geodesic_distance import geodesic_distance
from kinetree.tasks.numerics.geometry.nearest_nodes import nearest_nodes
from kinetree.tasks.numerics.geometry.sampling import farthest_points
from kinetree.tasks.numerics.geometry.surface import Surface


def test_the_nearest_nodes_are_those_of_all_distances():
    V, F = tube(around=24, along=40)
    surface = Surface.of(V, F)
    node = farthest_points(surface, np.ones(len(V)), 60)
    nearest, distance = nearest_nodes(surface, node, 5)
    every = geodesic_distance(surface, node)
    np.testing.assert_allclose(distance, np.sort(every, axis=0)[:5].T, atol=1e-9)
    np.testing.assert_allclose(np.take_along_axis(every, nearest.T, axis=0).T, distance, atol=1e-9)


def test_a_vertex_has_no_more_neighbours_than_its_component_has_nodes():
    V, F = two_components(2)
    surface = Surface.of(V, F)
    node = farthest_points(surface, np.ones(len(V)), 5)
    nearest, distance = nearest_nodes(surface, node, 5)
    first = np.arange(len(V)) < len(V) // 2
    mine = (node < len(V) // 2).sum()
    assert 0 < mine < 5
    np.testing.assert_array_equal((nearest[first] >= 0).sum(axis=1), mine)
    np.testing.assert_array_equal(np.isinf(distance), nearest < 0)


def test_where_every_vertex_is_a_node_each_has_the_neighbours_it_wants():
    V, F = sphere(1)
    nearest, distance = nearest_nodes(Surface.of(V, F), np.arange(len(V)), 5)
    np.testing.assert_array_equal(nearest[:, 0], np.arange(len(V)))
    assert np.isfinite(distance).all()
