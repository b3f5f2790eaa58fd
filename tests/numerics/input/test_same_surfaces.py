"""Laws of what is the same surface: in any order of vertices and faces, and as far as formats keep coordinates."""

import numpy as np
import pytest
from shapes import sphere

from kinetree.tasks.numerics.input.bad_frames import frame_measures
from kinetree.tasks.numerics.input.same_surfaces import SameSurfaceSettings, have_same_measures, have_same_vertices

V, F = sphere(3)
V = V * (1.0, 2.0, 3.0)
SIZE = float(np.linalg.norm(np.ptp(V, axis=0)))
REACH = SameSurfaceSettings().distance * SIZE


def are_same(W, G):
    measures = [[frame_measures(*mesh)] for mesh in ((V, F), (W, G))]
    return have_same_measures(*measures) and have_same_vertices(V, F, W, G) and have_same_vertices(W, G, V, F)


def test_order_of_vertices_and_faces_does_not_matter_nor_do_vertices_without_a_face():
    rng = np.random.default_rng(0)
    order = rng.permutation(len(V))
    W = np.concatenate([V[order], [[9.0, 9.0, 9.0]]])
    assert are_same(W, np.argsort(order)[F][rng.permutation(len(F))])


def test_three_vertices_of_its_own_for_every_face_are_the_same_surface():
    assert are_same(V[F].reshape(-1, 3), np.arange(3 * len(F)).reshape(-1, 3))


def test_coordinates_may_be_rounded_and_no_more():
    rng = np.random.default_rng(0)
    away = rng.normal(size=V.shape)
    away /= np.linalg.norm(away, axis=1, keepdims=True)
    assert are_same(V + 0.5 * REACH * away, F)
    assert are_same(V + 2.0 * REACH * away, F) is False


def test_one_vertex_elsewhere_is_another_surface():
    W = V.copy()
    W[0] += 2.0 * REACH
    assert not are_same(W, F)
    assert not are_same(V[F[1:]].reshape(-1, 3)[: 3 * len(F) // 2], np.arange(3 * (len(F) // 2)).reshape(-1, 3))


@pytest.mark.parametrize("count", [0, 2])
def test_takes_without_measures_or_of_other_lengths_are_never_the_same(count):
    own = frame_measures(V, F)
    assert not have_same_measures([own] * count, [own] * (1 if count else 0))
