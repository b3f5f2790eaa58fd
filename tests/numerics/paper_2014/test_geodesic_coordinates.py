"""Laws of geodesic coordinates and of the mapping by them, on shapes whose distances do not change as they bend."""

import numpy as np
import pytest
from limbs import bent, tube
from shapes import flat_grid, folded, two_components, y_pipe

from kinetree.tasks.numerics.paper_2014.geodesic_coordinates import (
    geodesic_coordinates,
    middle_frame,
    nearest_in_coordinates,
    own_tips,
)

SHEET, FACES = flat_grid(16, 12)
CORNERS = np.array([0, 11, 15 * 12])


def test_coordinates_of_a_leaf_are_nought_there_and_straight_lines_on_a_plane():
    X = geodesic_coordinates(SHEET, FACES, CORNERS)
    np.testing.assert_array_equal(X[np.arange(3), CORNERS], 0.0)
    np.testing.assert_allclose(X, np.linalg.norm(SHEET[CORNERS][:, None] - SHEET[None], axis=2), rtol=0.01)


def test_body_without_leaves_has_no_coordinates_and_no_mapping():
    X = geodesic_coordinates(SHEET, FACES, [])
    assert X.shape == (0, len(SHEET))
    image, away = nearest_in_coordinates(X, X)
    assert (image == -1).all()
    assert np.isnan(away).all()


def test_outside_the_largest_component_there_are_no_coordinates():
    V, F = two_components(2)
    half = len(V) // 2
    V[half:] *= 0.9
    X = geodesic_coordinates(V, F, [0, 5, 17])
    assert np.isfinite(X[:, :half]).all()
    assert np.isnan(X[:, half:]).all()
    image, _ = nearest_in_coordinates(X, X)
    np.testing.assert_array_equal(image, np.where(np.arange(len(V)) < half, np.arange(len(V)), -1))


@pytest.mark.parametrize("angle", [0.5, 1.5])
def test_folding_a_sheet_moves_no_vertex_in_coordinates(angle):
    before = geodesic_coordinates(SHEET, FACES, CORNERS)
    after = geodesic_coordinates(folded(SHEET, 7.0, angle), FACES, CORNERS)
    image, away = nearest_in_coordinates(before, after)
    np.testing.assert_array_equal(image, np.arange(len(SHEET)))
    assert away.max() < 1e-4


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


def test_coordinates_turn_with_a_body_of_three_equal_arms():
    V, F, turned = y_pipe(12, 3)
    tips = [int(np.linalg.norm(V, axis=1).argmax())]
    tips += [int(turned[tips[0]]), int(turned[turned[tips[0]]])]
    X = geodesic_coordinates(V, F, tips)
    np.testing.assert_allclose(X[[1, 2, 0]][:, turned], X, atol=0.02 * X.max())


def test_middle_is_the_middle_unless_leaves_are_hidden_there():
    assert [middle_frame(np.ones((3, n), bool)) for n in (1, 2, 3, 12)] == [0, 0, 1, 5]
    seen = np.ones((3, 9), bool)
    seen[1, 3:6] = False
    assert middle_frame(seen) == 2
    assert middle_frame(np.zeros((0, 5), bool)) == 2


def test_frame_is_known_by_its_tips():
    rng = np.random.default_rng(0)
    trail = rng.normal(size=(3, 5, 3))
    trail[1, 2] = np.nan
    assert own_tips(trail, trail[[2, 0], 2]).tolist() == [1, -1, 0]
    assert own_tips(trail, np.concatenate([rng.normal(size=(1, 3)), trail[[0, 1, 2], 4]])).tolist() == [1, 2, 3]
    assert own_tips(trail, np.zeros((0, 3))).tolist() == [-1, -1, -1]
    assert own_tips(trail[:0], trail[0]).tolist() == []
