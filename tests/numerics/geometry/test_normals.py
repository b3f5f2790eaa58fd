"""Laws of smoothed normals, on spheres and planes."""

import numpy as np
import pytest
from shapes import flat_grid, sphere

from kinetree.tasks.numerics.geometry.normals import smoothed_normals


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
