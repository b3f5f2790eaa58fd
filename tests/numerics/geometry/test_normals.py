"""Laws of smoothed normals, on spheres and planes."""

import numpy as np
import pytest
import trimesh
from shapes import flat_grid, sphere

from kinetree.tasks.numerics.geometry.normals import area_vectors, face_areas, smoothed_normals, vertex_areas, vertex_normals


@pytest.mark.parametrize("rounds", [0, 2, 5])
def test_normals_of_a_sphere_point_away_from_its_centre_within_a_third_of_an_edge(rounds):
    V, F = sphere(4)
    edge = np.linalg.norm(V[F[:, 1]] - V[F[:, 0]], axis=1).mean()
    assert np.linalg.norm(smoothed_normals(V, F, rounds) - V, axis=1).max() < edge / 3


def test_normals_of_a_plane_are_the_planes_however_it_is_cut():
    V, F = flat_grid(7, 5, shear=1.5)
    np.testing.assert_allclose(smoothed_normals(V, F), np.tile([0.0, 0.0, 1.0], (len(V), 1)), atol=1e-12)


def test_smoothing_takes_noise_out_of_normals():
    V, F = sphere(4)
    noisy = V * (1 + 0.005 * np.random.default_rng(0).normal(size=(len(V), 1)))
    error = [np.linalg.norm(smoothed_normals(noisy, F, rounds) - V, axis=1).mean() for rounds in (0, 1, 2)]
    assert error[0] > 1.5 * error[1] > 1.5 * error[2]


def test_a_vertex_without_a_face_has_no_normal():
    V, F = sphere(1)
    N = smoothed_normals(np.vstack([V, [5.0, 5.0, 5.0]]), F)
    np.testing.assert_array_equal(N[-1], 0.0)
    np.testing.assert_allclose(np.linalg.norm(N[:-1], axis=1), 1.0, atol=1e-12)


def test_normals_turn_with_the_surface_and_back_when_it_is_turned_inside_out():
    V, F = sphere(2)
    Q, _ = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))
    if np.linalg.det(Q) < 0:
        Q[:, 0] *= -1
    np.testing.assert_allclose(smoothed_normals(V @ Q.T, F), smoothed_normals(V, F) @ Q.T, atol=1e-12)
    np.testing.assert_allclose(smoothed_normals(V, F[:, ::-1]), -smoothed_normals(V, F), atol=1e-12)


def test_areas_and_normals_of_a_box_are_those_of_its_sides():
    box = trimesh.creation.box((1.0, 2.0, 3.0))
    V, F = np.array(box.vertices), np.array(box.faces)
    np.testing.assert_allclose(area_vectors(V, F), box.face_normals * box.area_faces[:, None], atol=1e-12)
    np.testing.assert_allclose(face_areas(V, F), box.area_faces)
    assert vertex_areas(V, F).sum() == pytest.approx(22.0)


def test_area_of_a_vertex_is_a_third_of_the_faces_around_it():
    V, F = flat_grid(5, 5)
    area = vertex_areas(V, F).reshape(5, 5)
    np.testing.assert_allclose(area[1:-1, 1:-1], 1.0)
    assert vertex_areas(np.vstack([V, V[:1]]), F)[-1] == 0.0


def test_vertex_normals_without_smoothing_are_the_smoothed_ones_of_no_rounds():
    V, F = sphere(2)
    np.testing.assert_array_equal(vertex_normals(V, F), smoothed_normals(V, F, 0))
