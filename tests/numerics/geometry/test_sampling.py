"""Laws of farthest-point sampling over a surface, on planes, tubes and spheres."""

import numpy as np
import pytest
from limbs import tube
from shapes import flat_grid, sphere

from kinetree.tasks.numerics.geometry.geodesic_distance import geodesic_distance
from kinetree.tasks.numerics.geometry.sampling import farthest_points, farthest_points_with_fields
from kinetree.tasks.numerics.geometry.surface import Surface


def test_nodes_are_different_vertices_in_ascending_order():
    V, F = sphere(3)
    node = farthest_points(Surface.of(V, F), np.ones(len(V)), 50)
    assert len(node) == 50
    assert (np.diff(node) > 0).all()


def test_no_two_nodes_are_nearer_than_the_largest_gap_they_leave():
    V, F = tube(around=32, along=64)
    surface = Surface.of(V, F)
    node = farthest_points(surface, np.ones(len(V)), 40)
    distance = geodesic_distance(surface, node)
    between = distance[:, node] + np.diag(np.full(40, np.inf))
    assert between.min() > 0.95 * distance.min(axis=0).max()


def test_where_half_the_spacing_is_wanted_gaps_are_half_as_wide():
    V, F = flat_grid(60, 60)
    surface = Surface.of(V, F)
    node = farthest_points(surface, np.where(V[:, 0] < 30, 1.0, 0.5), 120)
    gap = geodesic_distance(surface, node).min(axis=0)
    wide, narrow = gap[V[:, 0] < 25].max(), gap[V[:, 0] > 35].max()
    assert narrow / wide == pytest.approx(0.5, abs=0.12)


def test_more_nodes_than_vertices_are_all_vertices():
    V, F = sphere(1)
    np.testing.assert_array_equal(farthest_points(Surface.of(V, F), np.ones(len(V)), 10**4), np.arange(len(V)))


def test_points_with_fields_are_the_same_points_in_the_order_of_choice_and_their_distances():
    surface = Surface.of(*sphere(3))
    point, distance, cell = farthest_points_with_fields(surface, 30)
    np.testing.assert_array_equal(np.sort(point), farthest_points(surface, np.ones(len(cell)), 30))
    np.testing.assert_array_equal(distance, geodesic_distance(surface, point))
    np.testing.assert_array_equal(distance.min(axis=0), distance[cell, np.arange(len(cell))])
    np.testing.assert_array_equal(point[:10], farthest_points_with_fields(surface, 10)[0])
