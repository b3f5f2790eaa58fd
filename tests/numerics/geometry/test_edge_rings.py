"""Laws of counted neighbours, and of normals averaged over them: those of the general functions, to the last bit."""

import numpy as np
import pytest
from limbs import tube
from shapes import sphere, two_components

from kinetree.tasks.numerics.geometry.edge_rings import averaged_normals, edge_rings
from kinetree.tasks.numerics.geometry.neighbours import rings
from kinetree.tasks.numerics.geometry.normals import smoothed_normals

SPHERE = sphere(3)
SHAPES = {
    "sphere": SPHERE,
    "tube": tube(around=24, along=40),
    "two components": two_components(2),
    "with a border": (SPHERE[0], SPHERE[1][:500]),
    "a fan": (np.random.default_rng(0).normal(size=(202, 3)), np.array([[0, k, k + 1] for k in range(200, 0, -1)])),
    "three faces at an edge": (np.random.default_rng(0).normal(size=(6, 3)), np.array([[0, 1, 2], [0, 1, 3], [1, 0, 4]])),
    "one face twice": (np.random.default_rng(0).normal(size=(4, 3)), np.array([[0, 1, 2], [0, 1, 2]])),
    "a vertex in no face": (np.random.default_rng(0).normal(size=(5, 3)), np.array([[4, 1, 2]])),
    "no face": (np.zeros((3, 3)), np.empty((0, 3), np.int64)),
}


@pytest.mark.parametrize("name", SHAPES)
def test_neighbours_are_those_of_rings(name):
    V, F = SHAPES[name]
    start, ring, count = edge_rings(F.astype(np.int64), len(V))
    for mine, general in zip((start, ring), rings(F.astype(np.int64), len(V)), strict=True):
        assert mine.dtype == general.dtype
        np.testing.assert_array_equal(mine, general)
    assert count.sum() == 6 * len(F)


def test_counts_are_the_faces_at_an_edge():
    _, F = SHAPES["three faces at an edge"]
    start, ring, count = edge_rings(F, 6)
    assert dict(zip(ring[start[0] : start[1]].tolist(), count[start[0] : start[1]].tolist(), strict=True)) == {
        1: 3,
        2: 1,
        3: 1,
        4: 1,
    }


@pytest.mark.parametrize("name", SHAPES)
def test_normals_are_the_smoothed_ones_to_the_last_bit(name):
    V, F = SHAPES[name]
    faces = F.astype(np.int64)
    rng = np.random.default_rng(1)
    rough = V + 0.01 * rng.normal(size=V.shape)
    mine = averaged_normals(rough, faces, *edge_rings(faces, len(V)))
    assert mine.tobytes() == smoothed_normals(rough, faces).tobytes()
