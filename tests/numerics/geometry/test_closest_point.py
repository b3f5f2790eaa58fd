"""Laws of the nearest point of a surface, on boxes, spheres and triangles."""

import numpy as np
import pytest
import trimesh
from shapes import sphere, y_pipe

from kinetree.tasks.numerics.geometry.closest_point import SurfaceTree, projected


def points(projection, V, F):
    return np.einsum("pk,pkx->px", projection.share, V[F[projection.face]])


def test_points_of_the_surface_are_their_own_nearest_points(rng):
    V, F = sphere(3)
    face = rng.integers(len(F), size=200)
    P = np.einsum("pk,pkx->px", rng.dirichlet([1, 1, 1], size=200), V[F[face]])
    nearest = projected(P, V, F)
    assert nearest.distance.max() < 1e-12
    np.testing.assert_allclose(points(nearest, V, F), P, atol=1e-12)


def test_tree_that_is_asked_again_answers_as_one_made_anew(rng):
    V, F = sphere(2)
    tree = SurfaceTree.of(V, F)
    for P in (rng.normal(size=(40, 3)), rng.normal(size=(7, 3)) * 5):
        for by_tree, anew in zip(tree.nearest(P), projected(P, V, F), strict=True):
            np.testing.assert_array_equal(by_tree, anew)


def test_shares_are_a_partition_of_unity_and_reach_the_stated_distance(rng):
    V, F = sphere(2)
    P = rng.normal(size=(300, 3))
    nearest = projected(P, V, F)
    assert nearest.share.min() > -1e-12
    np.testing.assert_allclose(nearest.share.sum(axis=1), 1.0, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(P - points(nearest, V, F), axis=1), nearest.distance, atol=1e-12)


def test_outside_a_box_the_distance_is_that_of_the_box(rng):
    box = trimesh.creation.box((2.0, 2.0, 2.0))
    P = rng.uniform(-3, 3, size=(500, 3))
    P = P[np.abs(P).max(axis=1) > 1]
    exact = np.linalg.norm(np.maximum(np.abs(P) - 1.0, 0.0), axis=1)
    np.testing.assert_allclose(projected(P, np.array(box.vertices), np.array(box.faces)).distance, exact, atol=1e-12)


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
    nearest = projected(np.array([[1.5, 1.0, 0.0], [3.0, 0.0, 0.0]]), V, F)
    np.testing.assert_allclose(nearest.distance, [1.0, 1.0], atol=1e-12)


def test_unused_vertices_are_no_part_of_the_surface():
    V, F = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0.2, 0.2, 5.0]]), np.array([[0, 1, 2]])
    assert projected(np.array([[0.2, 0.2, 5.0]]), V, F).distance[0] == pytest.approx(5.0)


def test_the_surface_moved_with_the_points_changes_nothing_but_rounding(rng):
    V, F = sphere(2)
    P = rng.normal(size=(100, 3))
    Q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    moved = projected(P @ Q.T + 5.0, V @ Q.T + 5.0, F)
    np.testing.assert_allclose(moved.distance, projected(P, V, F).distance, atol=1e-12)


def nearest_of_all(P, V, F):
    """(point,) by trying every face, its plane and its three sides each by itself."""
    a, b, c = (V[F[:, k]] for k in range(3))
    n = np.cross(b - a, c - a)
    square = (n * n).sum(axis=1)
    least = np.full(len(P), np.inf)
    for p, q in ((a, b), (b, c), (c, a)):
        share = np.einsum("pfx,fx->pf", P[:, None] - p, q - p) / np.maximum(((q - p) ** 2).sum(axis=1), 1e-300)
        foot = p + np.clip(share, 0, 1)[..., None] * (q - p)
        least = np.minimum(least, np.linalg.norm(P[:, None] - foot, axis=2).min(axis=1))
    inside = square > 1e-24
    for p, q in ((a, b), (b, c), (c, a)):
        side = np.cross(n, q - p)
        inside = inside & (np.einsum("pfx,fx->pf", P[:, None] - p, side) >= 0)
    height = np.abs(np.einsum("pfx,fx->pf", P[:, None] - a, n)) / np.sqrt(np.maximum(square, 1e-300))
    return np.minimum(least, np.where(inside, height, np.inf).min(axis=1))


@pytest.mark.parametrize("faces", [1, 3, 4, 5, 17, 300])
@pytest.mark.parametrize("thin", [1.0, 1e-3])
def test_no_face_is_nearer_however_long_and_thin_faces_are(rng, faces, thin):
    V = rng.normal(size=(3 * faces, 3)) * rng.uniform(0.01, 3.0, size=(3 * faces, 1))
    F = np.arange(3 * faces).reshape(-1, 3)
    V[F[:, 2]] = V[F[:, 0]] + rng.uniform(size=(faces, 1)) * (V[F[:, 1]] - V[F[:, 0]]) + thin * V[F[:, 2]]
    P = rng.normal(size=(200, 3)) * 2.0
    nearest = projected(P, V, F)
    np.testing.assert_allclose(nearest.distance, nearest_of_all(P, V, F), atol=1e-9)
    np.testing.assert_allclose(np.linalg.norm(P - points(nearest, V, F), axis=1), nearest.distance, atol=1e-9)


def test_another_program_finds_the_same_points_of_a_body(rng):
    igl = pytest.importorskip("igl", reason="compares with libigl's nearest points; pip install libigl")
    V, F, _ = y_pipe()
    V = V + rng.normal(scale=0.1, size=V.shape)
    P = V[rng.integers(len(V), size=500)] + rng.normal(scale=0.5, size=(500, 3))
    square, _, there = igl.point_mesh_squared_distance(P, V, F)
    nearest = projected(P, V, F)
    np.testing.assert_allclose(nearest.distance, np.sqrt(square), atol=1e-9)
    np.testing.assert_allclose(points(nearest, V, F), there, atol=1e-7)


def test_of_faces_equally_near_the_first_is_taken_whatever_else_is_asked(rng):
    V, F = sphere(2)
    P = np.concatenate([V, V[F].mean(axis=1), rng.normal(size=(50, 3))])
    together = projected(P, V, np.concatenate([F, F]))
    assert together.face.max() < len(F)
    alone = [projected(p[None], V, F) for p in P]
    np.testing.assert_array_equal(together.face, [one.face[0] for one in alone])
    np.testing.assert_array_equal(together.share, [one.share[0] for one in alone])


@pytest.fixture
def rng():
    return np.random.default_rng(0)
