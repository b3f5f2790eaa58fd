"""Contract of the landed projection: corners of faces of the skeleton's mesh."""

import numpy as np
from mesoscopic import made

from kinetree.schemas.paper_2014.transfer import Transfer
from kinetree.tasks.paper_2014.transferred_projection import transferred_projection


def test_every_vertex_that_lands_is_a_corner_of_a_face_and_others_say_so() -> None:
    here = made()
    corner = np.array([5, 0, -1])
    way = Transfer(corner=corner, distance=np.array([0.5, 0.0, np.nan]), place=np.zeros((0, 3)))
    told = transferred_projection((way,), here.skeleton)
    at = np.einsum("vk,vkx->vx", told.share[:2], here.skeleton.vertices[here.skeleton.faces[told.face[:2]]])
    np.testing.assert_array_equal(at, here.skeleton.vertices[corner[:2]])
    assert told.face[2] == -1
    assert told.share[2].tolist() == [0, 0, 0]
    assert np.isnan(told.distance[2])
