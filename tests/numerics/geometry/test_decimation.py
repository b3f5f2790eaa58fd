"""Laws of coarser meshes."""

import numpy as np
from shapes import sphere

from kinetree.tasks.numerics.geometry.decimation import decimated


def test_coarser_mesh_uses_vertices_of_the_mesh_and_stays_a_sphere():
    V, F = sphere(4)
    vertex, faces = decimated(V, F, 300)
    assert 200 < len(vertex) < 400
    assert faces.max() == len(vertex) - 1
    centre = V[vertex][faces].mean(axis=1)
    assert np.linalg.norm(centre, axis=1).min() > 0.95


def test_small_mesh_is_left_as_it_is():
    V, F = sphere(1)
    vertex, faces = decimated(V, F, 10_000)
    np.testing.assert_array_equal(vertex, np.arange(len(V)))
    np.testing.assert_array_equal(faces, F)
