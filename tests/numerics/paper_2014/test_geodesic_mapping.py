"""Laws of the mapping by geodesic coordinates, on shapes whose distances do not change as they bend."""

import numpy as np
import pytest
from limbs import bent, tube
from shapes import flat_grid, folded

from kinetree.tasks.numerics.paper_2014.geodesic_coordinates import geodesic_coordinates
from kinetree.tasks.numerics.paper_2014.geodesic_mapping import image_coordinates, nearest_in_coordinates

SHEET, FACES = flat_grid(16, 12)
CORNERS = np.array([0, 11, 15 * 12])


@pytest.mark.parametrize("angle", [0.5, 1.5])
def test_folding_a_sheet_moves_no_vertex_in_coordinates(angle):
    before = geodesic_coordinates(SHEET, FACES, CORNERS)
    after = geodesic_coordinates(folded(SHEET, 7.0, angle), FACES, CORNERS)
    image, distance = nearest_in_coordinates(before, after)
    np.testing.assert_array_equal(image, np.arange(len(SHEET)))
    assert distance.max() < 1e-4


def test_mapping_follows_vertices_that_are_numbered_anew():
    order = np.random.default_rng(3).permutation(len(SHEET))
    place = np.argsort(order)
    before = geodesic_coordinates(SHEET, FACES, CORNERS)
    image, _ = nearest_in_coordinates(before, geodesic_coordinates(SHEET[order], place[FACES], place[CORNERS]))
    np.testing.assert_array_equal(image, place)


def test_two_leaves_cannot_tell_the_points_of_a_ring_apart():
    V, F = tube()
    leaves = [len(V) - 2, len(V) - 1]
    before = geodesic_coordinates(V, F, leaves)
    image, _ = nearest_in_coordinates(before, geodesic_coordinates(bent(V, 0.4), F, leaves))
    lengthwise, across = np.abs(V[image] - V)[:, 2], np.linalg.norm((V[image] - V)[:, :2], axis=1)
    assert lengthwise.mean() < 0.3
    assert across.max() > 1.0


def test_leaf_that_one_of_the_frames_does_not_see_does_not_count():
    X = geodesic_coordinates(SHEET, FACES, [*CORNERS, 100])
    hidden = X.copy()
    hidden[3] = np.nan
    np.testing.assert_array_equal(nearest_in_coordinates(X, hidden)[0], np.arange(len(SHEET)))
    alone = np.full_like(X, np.nan)
    assert (nearest_in_coordinates(X, alone)[0] == -1).all()


def test_coordinates_are_those_of_the_images_and_stay_where_the_frame_has_none():
    before, X = np.array([[1.0, 2.0], [3.0, 4.0]]), np.array([[10.0, 20.0, 30.0], [np.nan] * 3])
    assert image_coordinates(before, X, np.array([2, -1])).tolist() == [[30.0, 2.0], [3.0, 4.0]]
