"""Laws of geodesic coordinates."""

import numpy as np
from shapes import flat_grid, two_components, y_pipe

from kinetree.tasks.numerics.paper_2014.geodesic_coordinates import geodesic_coordinates
from kinetree.tasks.numerics.paper_2014.geodesic_mapping import nearest_in_coordinates

SHEET, FACES = flat_grid(16, 12)
CORNERS = np.array([0, 11, 15 * 12])


def test_coordinates_of_a_leaf_are_nought_there_and_straight_lines_on_a_plane():
    X = geodesic_coordinates(SHEET, FACES, CORNERS)
    np.testing.assert_array_equal(X[np.arange(3), CORNERS], 0.0)
    np.testing.assert_allclose(X, np.linalg.norm(SHEET[CORNERS][:, None] - SHEET[None], axis=2), rtol=0.01)


def test_body_without_leaves_has_no_coordinates_and_no_mapping():
    X = geodesic_coordinates(SHEET, FACES, [])
    assert X.shape == (0, len(SHEET))
    image, distance = nearest_in_coordinates(X, X)
    assert (image == -1).all()
    assert np.isnan(distance).all()


def test_outside_the_largest_component_there_are_no_coordinates():
    V, F = two_components(2)
    half = len(V) // 2
    V[half:] *= 0.9
    X = geodesic_coordinates(V, F, [0, 5, 17])
    assert np.isfinite(X[:, :half]).all()
    assert np.isnan(X[:, half:]).all()
    image, _ = nearest_in_coordinates(X, X)
    np.testing.assert_array_equal(image, np.where(np.arange(len(V)) < half, np.arange(len(V)), -1))


def test_coordinates_turn_with_a_body_of_three_equal_arms():
    V, F, turned = y_pipe(12, 3)
    leaves = [int(np.linalg.norm(V, axis=1).argmax())]
    leaves += [int(turned[leaves[0]]), int(turned[turned[leaves[0]]])]
    X = geodesic_coordinates(V, F, leaves)
    np.testing.assert_allclose(X[[1, 2, 0]][:, turned], X, atol=0.02 * X.max())
