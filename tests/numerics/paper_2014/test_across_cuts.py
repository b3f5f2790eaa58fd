"""Laws of the way over cuts."""

import numpy as np

from kinetree.tasks.numerics.paper_2014.across_cuts import carried, centroids, labels, way
from kinetree.tasks.numerics.paper_2014.bones import Areas

ONWARD = [np.array([1, 2, -1]), np.array([3, 2, 1, 0])]
BACKWARD = [np.array([-1, 0, 1, 2]), np.array([3, 2, 1, 0])]
STRIP = Areas(
    np.array([0, 0, 1, 1, 2, 2]), np.array([True, False, True]), np.array([0, 0, 1]), np.array([0, 2, 0]), np.array([1, 3, 1])
)


def test_way_leads_over_all_cuts_and_back():
    assert way(ONWARD, BACKWARD, 0, 0, 3).tolist() == [0, 1, 2]
    assert way(ONWARD, BACKWARD, 0, 2, 3).tolist() == [2, 1, -1]
    assert way(ONWARD, BACKWARD, 2, 0, 4).tolist() == [2, 1, 0, -1]


def test_areas_of_cones_go_by_annulus_and_others_by_the_way():
    home = np.array([5, 4, 3, 2, 1, 0, -1])
    ring = np.array([[-1, -1, 3, 3, 2, 1, 0]])
    assert labels(STRIP, 1, ring, home).tolist() == [2, 2, 1, 1, 1, 0, 0]


def test_vertex_that_its_own_cone_no_longer_claims_is_unknown():
    assert labels(STRIP, 1, np.full((1, 2), -1), np.array([0, 4])).tolist() == [-1, 2]


def test_vertex_claimed_by_two_cones_goes_the_way():
    both = Areas(np.array([0, 1]), np.ones(2, bool), np.array([0, 1]), np.zeros(2, int), np.ones(2, int))
    assert labels(both, 2, np.zeros((2, 1), int), np.array([1])).tolist() == [1]


def test_centroid_is_of_the_surface_and_of_what_is_seen():
    x = np.array([[[0.0, 0, 0], [4.0, 0, 0], [9.0, 9, 9]]])
    found = centroids(x, np.array([0, 0, -1]), np.array([3.0, 1.0, 1.0]), 2)
    assert found[0, 0].tolist() == [1.0, 0.0, 0.0]
    assert np.isnan(found[0, 1]).all()


def test_what_has_a_way_is_carried_and_the_rest_is_not_known():
    x = np.arange(6.0).reshape(1, 2, 3)
    out = carried(x, np.array([1, -1, 0]))
    np.testing.assert_array_equal(out[0, [0, 2]], x[0, [1, 0]])
    assert np.isnan(out[0, 1]).all()
