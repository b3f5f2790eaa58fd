"""Laws of the nearest point of a surface, on boxes, spheres and triangles."""

import numpy as np
import pytest
import trimesh
from shapes import sphere

from kinetree.tasks.numerics.geometry.closest_point import projected


def points(projection, V, F):
    return np.einsum("pk,pkx->px", projection.share, V[F[projection.face]])


def test_points_of_the_surface_are_their_own_nearest_points(rng):
    V, F = sphere(3)
    face = rng.integers(len(F), size=200)
    P = np.einsum("pk,pkx->px", rng.dirichlet([1, 1, 1], size=200), V[F[face]])
    found = projected(P, V, F)
    assert found.distance.max() < 1e-12
    np.testing.assert_allclose(points(found, V, F), P, atol=1e-12)


def test_shares_are_a_partition_of_unity_and_reach_the_stated_distance(rng):
    V, F = sphere(2)
    P = rng.normal(size=(300, 3))
    found = projected(P, V, F)
    assert found.share.min() > -1e-12
    np.testing.assert_allclose(found.share.sum(axis=1), 1.0, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(P - points(found, V, F), axis=1), found.distance, atol=1e-12)


def test_outside_a_box_the_distance_is_that_of_the_box(rng):
    box = trimesh.creation.box((2.0, 2.0, 2.0)).subdivide().subdivide().subdivide()
    P = rng.uniform(-3, 3, size=(500, 3))
    P = P[np.abs(P).max(axis=1) > 1]
    exact = np.linalg.norm(np.maximum(np.abs(P) - 1.0, 0.0), axis=1)
    np.testing.assert_allclose(projected(P, np.array(box.vertices), np.array(box.faces), 8).distance, exact, atol=1e-12)


@pytest.mark.parametrize(
    ("point", "share"),
    [
        ((-1.0, -1.0, 1.0), (1, 0, 0)),
        ((3.0, -1.0, 1.0), (0, 1, 0)),
        ((-1.0, 3.0, 1.0), (0, 0, 1)),
        ((0.5, -2.0, 0.0), (0.5, 0.5, 0)),
        ((-2.0, 0.25, 0.0), (0.75, 0, 0.25)),
        ((1.0, 1.0, 0.0), (0, 0.5, 0.5)),
        ((0.2, 0.3, -4.0), (0.5, 0.2, 0.3)),
    ],
)
def test_every_corner_side_and_the_inside_of_a_triangle_can_be_nearest(point, share):
    V, F = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]])
    np.testing.assert_allclose(projected(np.array([point]), V, F).share[0], share, atol=1e-12)


def test_a_triangle_without_area_is_its_longest_side():
    V, F = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0]]), np.array([[0, 1, 2]])
    found = projected(np.array([[1.5, 1.0, 0.0], [3.0, 0.0, 0.0]]), V, F)
    np.testing.assert_allclose(found.distance, [1.0, 1.0], atol=1e-12)


def test_unused_vertices_are_no_part_of_the_surface():
    V, F = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0.2, 0.2, 5.0]]), np.array([[0, 1, 2]])
    assert projected(np.array([[0.2, 0.2, 5.0]]), V, F).distance[0] == pytest.approx(5.0)


def test_the_surface_moved_with_the_points_changes_nothing_but_rounding(rng):
    V, F = sphere(2)
    P = rng.normal(size=(100, 3))
    Q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    moved = projected(P @ Q.T + 5.0, V @ Q.T + 5.0, F)
    np.testing.assert_allclose(moved.distance, projected(P, V, F).distance, atol=1e-12)


@pytest.fixture
def rng():
    return np.random.default_rng(0)
