"""Laws of vertices as corners of faces."""

import numpy as np
from limbs import tube

from kinetree.tasks.numerics.paper_2014.transferred_projection import first_corners

V, F = tube()


def test_every_vertex_is_a_corner_of_its_face():
    face, share = first_corners(len(V) + 1, F)
    assert (np.einsum("vk,vk->v", share[:-1], F[face[:-1]]) == np.arange(len(V))).all()
    assert face[-1] == -1
    assert share[-1].tolist() == [0, 0, 0]
