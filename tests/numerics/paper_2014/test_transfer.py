"""Laws of labels that come back over two meshes."""

import numpy as np
from limbs import tube

from kinetree.tasks.numerics.paper_2014.transfer import completed, first_corners, landed

V, F = tube()


def test_points_land_on_the_vertex_to_which_the_nearest_leads():
    way = np.arange(len(V))[::-1]
    corner, distance = landed(V + 1e-3, V, np.ones(len(V)), way)
    assert (corner == way).all()
    np.testing.assert_allclose(distance, np.sqrt(3) * 1e-3)


def test_vertices_that_lead_nowhere_are_passed_by():
    way = np.where(V[:, 2] > 0, np.arange(len(V)), -1)
    assert V[landed(V, V, np.ones(len(V)), way)[0], 2].min() > 0
    corner, distance = landed(V, V, np.ones(len(V)), np.full(len(V), -1))
    assert (corner == -1).all()
    assert np.isnan(distance).all()


def test_every_vertex_is_a_corner_of_its_face():
    face, share = first_corners(len(V) + 1, F)
    assert (np.einsum("vk,vk->v", share[:-1], F[face[:-1]]) == np.arange(len(V))).all()
    assert face[-1] == -1
    assert share[-1].tolist() == [0, 0, 0]


def test_places_that_are_missing_of_a_body_that_moves_rigidly_are_found_exactly():
    turn = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    x = V @ turn.T + [1, 2, 3]
    place = x.copy()
    place[:5] = np.nan
    np.testing.assert_allclose(completed(V, place), x, atol=1e-9)
    np.testing.assert_array_equal(completed(V, x), x)


def test_body_of_which_nothing_is_known_stays_as_it_was():
    np.testing.assert_array_equal(completed(V, np.full_like(V, np.nan)), V)
