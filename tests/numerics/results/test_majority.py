"""Laws of majorities and centroids over sets of vertices."""

import numpy as np

from kinetree.tasks.numerics.results.majority import centroids, labels_of_rings


def test_a_ring_has_the_label_that_has_most_of_its_area() -> None:
    cone, ring = np.array([0, 0, 0, 1, -2, 0]), np.array([0, 0, 0, 2, -1, 1])
    label, area = np.array([4, 4, 2, 1, 3, 0]), np.array([1.0, 1.0, 3.0, 1.0, 9.0, 1.0])
    np.testing.assert_array_equal(labels_of_rings(cone, ring, label, area, (2, 3)), [[2, 0, -1], [-1, -1, 1]])
    np.testing.assert_array_equal(labels_of_rings(cone * 0 - 1, ring, label, area, (1, 2)), [[-1, -1]])


def test_centroids_are_means_by_area_and_nothing_has_none() -> None:
    V, label = np.array([[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [1.0, 1.0, 1.0]]), np.array([0, 0, 2])
    found = centroids(V, label, np.array([1.0, 3.0, 2.0]), 3)
    np.testing.assert_allclose(found, [[3.0, 0.0, 0.0], [0.0, 0.0, 0.0], [1.0, 1.0, 1.0]])
