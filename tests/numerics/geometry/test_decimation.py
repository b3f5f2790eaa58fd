"""Laws of coarser meshes."""

import sys
from concurrent.futures import ThreadPoolExecutor

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


def test_threads_of_one_process_get_each_its_own_mesh():
    V, F = sphere(4)
    asked = [(V * (1.0, 1.0 + 0.3 * k, 1.0), F, 700 + 100 * k) for k in range(3)] * 20
    alone, interval = [decimated(*one) for one in asked[:3]] * 20, sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    try:
        with ThreadPoolExecutor(4) as threads:
            found = list(threads.map(lambda one: decimated(*one), asked))
    finally:
        sys.setswitchinterval(interval)
    for mine, other in zip(alone, found, strict=True):
        for a, b in zip(mine, other, strict=True):
            np.testing.assert_array_equal(a, b)
