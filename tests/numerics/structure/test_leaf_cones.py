"""Laws of cones: rings around a leaf up to where the body branches."""

import numpy as np
import shapes

from kinetree.tasks.numerics.geometry.geodesic_distance import geodesic_distance
from kinetree.tasks.numerics.geometry.neighbours import rings
from kinetree.tasks.numerics.geometry.surface import Surface
from kinetree.tasks.numerics.structure.leaf_cones import cones


def pipe():
    """A Y-pipe, its tips and the cones around them."""
    V, F, onto = shapes.y_pipe()
    surface = Surface.of(V, F)
    first = int(np.argmax(V[:, 0]))
    tips = np.array([first, onto[first], onto[onto[first]]])
    return V, surface, tips, geodesic_distance(surface, tips), rings(F, len(V))


def test_a_cone_ends_where_two_branches_with_leaves_part():
    V, surface, tips, distance, (start, ring) = pipe()
    C = cones(distance, surface.area, tips, start, ring, 40)
    # the tips are 28 from the middle, where arms of half width 4 meet
    for k, cone in enumerate(C):
        away = np.linalg.norm(V - V[tips[k]], axis=1)
        assert (cone[away < 31] >= 0).all()
        assert (cone[away > 36] < 0).all()


def test_rings_begin_at_the_leaf_and_grow_with_distance():
    _, surface, tips, distance, (start, ring) = pipe()
    for k, cone in enumerate(cones(distance, surface.area, tips, start, ring, 40)):
        inside = cone >= 0
        assert cone[tips[k]] == 0
        assert np.corrcoef(cone[inside], distance[k][inside])[0, 1] > 0.999
        np.testing.assert_array_equal(np.unique(cone[inside]), np.arange(cone.max() + 1))


def test_a_branch_that_holds_no_leaf_and_little_area_is_a_pocket():
    _, surface, tips, distance, (start, ring) = pipe()
    without = cones(distance[:2], surface.area, tips[:2], start, ring, 40, pocket=0.9)
    assert (without >= 0).all()


def test_one_leaf_has_the_whole_body():
    V, F = shapes.open_cylinder(20, 30)
    surface = Surface.of(V, F)
    start, ring = rings(F, len(V))
    C = cones(geodesic_distance(surface, np.array([0])), surface.area, np.array([0]), start, ring, 20)
    assert (C >= 0).all()
