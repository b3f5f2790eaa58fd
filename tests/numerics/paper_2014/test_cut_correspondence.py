"""Laws of relating two meshes that lie on each other."""

import numpy as np
from limbs import tube

from kinetree.tasks.numerics.geometry.normals import smoothed_normals
from kinetree.tasks.numerics.paper_2014.cut_correspondence import mutual_pairs, nearest_agreeing

V, F = tube(24, 48)
N = smoothed_normals(V, F)


def test_mesh_lies_on_itself():
    image, distance = nearest_agreeing(V, N, V, N)
    np.testing.assert_array_equal(image, np.arange(len(V)))
    np.testing.assert_array_equal(distance, 0.0)


def test_other_sampling_of_the_surface_is_nearer_than_an_edge():
    other, faces = tube(30, 60, start=0.1)
    image, distance = nearest_agreeing(V, N, other, smoothed_normals(other, faces))
    assert (image >= 0).all()
    assert distance.max() < 0.3
    np.testing.assert_allclose(np.linalg.norm(other[image] - V, axis=1), distance)


def test_other_side_of_a_thin_wall_is_no_partner():
    image, _ = nearest_agreeing(V, N, V + 0.01, -N)
    assert (image == -1).all()


def test_nothing_lies_on_no_mesh():
    image, distance = nearest_agreeing(V, N, V[:0], N[:0])
    assert (image == -1).all()
    assert np.isinf(distance).all()
    assert len(nearest_agreeing(V[:0], N[:0], V, N)[0]) == 0


def test_leaves_are_pairs_only_if_each_is_the_others_nearest_and_normals_agree():
    P = np.array([[0.0, 0, 0], [10, 0, 0], [10, 1, 0], [30, 0, 0]])
    Q = np.array([[30.5, 0, 0], [0.2, 0, 0], [9.9, 0, 0]])
    up = np.array([0.0, 0, 1])
    M = np.tile(up, (3, 1))
    assert mutual_pairs(P, np.tile(up, (4, 1)), Q, M).tolist() == [[0, 1], [1, 2], [3, 0]]
    assert mutual_pairs(P, np.tile(up, (4, 1)), Q, M * [[-1], [1], [1]]).tolist() == [[0, 1], [1, 2]]
    assert mutual_pairs(P[:0], M[:0], Q, M).shape == (0, 2)
