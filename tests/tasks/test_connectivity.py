"""Contract of connectivity: fixed exactly where every frame has the same faces over the same vertices."""

import numpy as np
import pytest

from kinetree.schemas.connectivity import Connectivity
from kinetree.schemas.mesh import Cleaning, Mesh
from kinetree.tasks.connectivity import connectivity

V = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
F = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]], dtype=np.int32)


def frame(vertices=V, faces=F, origin=None):
    back = np.arange(len(vertices)) if origin is None else np.array(origin)
    return Mesh(vertices=vertices, faces=faces, vertex_of_input=back, cleaning=Cleaning())


def test_moving_vertices_under_the_same_faces_are_fixed():
    made = connectivity({t: frame(V * (t + 1)) for t in range(4)})
    assert made == Connectivity(fixed=True, first_change=None, vertices=4, faces=4)


@pytest.mark.parametrize(
    "other",
    [
        frame(faces=F[::-1]),
        frame(faces=F[:3]),
        frame(faces=F[:, [1, 2, 0]]),
        frame(np.concatenate([V, V[:1] + 2]), F),
        frame(origin=[1, 0, 2, 3]),
        frame(origin=[0, 1, 2, 3, -1]),
    ],
    ids=[
        "other order of faces",
        "fewer faces",
        "turned corners",
        "more vertices",
        "other input vertices",
        "more input vertices",
    ],
)
def test_first_frame_that_differs_is_told_by_its_number(other):
    made = connectivity({10: frame(), 12: frame(V * 2), 14: other, 16: frame()})
    assert (made.fixed, made.first_change) == (False, 14)


def test_change_is_seen_against_the_first_frame():
    made = connectivity({0: frame(faces=F[:3]), 1: frame(), 2: frame()})
    assert (made.fixed, made.first_change, made.vertices, made.faces) == (False, 1, 4, 3)


def test_one_frame_alone_moves_nothing_and_is_not_fixed():
    made = connectivity({5: frame()})
    assert (made.fixed, made.first_change) == (False, None)
