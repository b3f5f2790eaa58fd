"""Laws of vertices and places transferred between meshes."""

import numpy as np
from limbs import tube

from kinetree.tasks.numerics.paper_2014.transfer import composed_map, mapped_positions, nearest_image

V, F = tube()
TO_NEXT = [np.array([1, 2, -1]), np.array([3, 2, 1, 0])]
TO_PREVIOUS = [np.array([-1, 0, 1, 2]), np.array([3, 2, 1, 0])]


def test_maps_are_composed_over_all_cuts_in_both_directions():
    assert composed_map(TO_NEXT, TO_PREVIOUS, 0, 0, 3).tolist() == [0, 1, 2]
    assert composed_map(TO_NEXT, TO_PREVIOUS, 0, 2, 3).tolist() == [2, 1, -1]
    assert composed_map(TO_NEXT, TO_PREVIOUS, 2, 0, 4).tolist() == [2, 1, 0, -1]


def test_positions_are_those_of_the_images_and_others_are_not_known():
    x = np.arange(6.0).reshape(1, 2, 3)
    out = mapped_positions(x, np.array([1, -1, 0]))
    np.testing.assert_array_equal(out[0, [0, 2]], x[0, [1, 0]])
    assert np.isnan(out[0, 1]).all()


def test_point_has_the_image_of_its_nearest_vertex():
    image = np.arange(len(V))[::-1]
    vertex, distance = nearest_image(V + 1e-3, V, np.ones(len(V)), image)
    assert (vertex == image).all()
    np.testing.assert_allclose(distance, np.sqrt(3) * 1e-3)


def test_vertices_without_an_image_are_left_out():
    image = np.where(V[:, 2] > 0, np.arange(len(V)), -1)
    assert V[nearest_image(V, V, np.ones(len(V)), image)[0], 2].min() > 0
    vertex, distance = nearest_image(V, V, np.ones(len(V)), np.full(len(V), -1))
    assert (vertex == -1).all()
    assert np.isnan(distance).all()
