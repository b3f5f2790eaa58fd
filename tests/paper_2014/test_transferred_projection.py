"""Contract of the transferred projection: corners of faces of the skeleton's mesh."""

import numpy as np
from mesoscopic import mesoscopic

from kinetree.schemas.paper_2014.transfer import Transfer
from kinetree.tasks.paper_2014.transferred_projection import transferred_projection


def test_every_corresponding_vertex_is_a_corner_of_a_face_and_others_have_none() -> None:
    here = mesoscopic()
    vertex = np.array([5, 0, -1])
    transfer = Transfer(
        model_vertex=vertex, distance=np.array([0.5, 0.0, np.nan]), model_position=np.zeros((0, 3)), tracked=False
    )
    projection = transferred_projection((transfer,), here.skeleton)
    at = np.einsum("vk,vkx->vx", projection.share[:2], here.skeleton.vertices[here.skeleton.faces[projection.face[:2]]])
    np.testing.assert_array_equal(at, here.skeleton.vertices[vertex[:2]])
    assert projection.face[2] == -1
    assert projection.share[2].tolist() == [0, 0, 0]
    assert np.isnan(projection.distance[2])
