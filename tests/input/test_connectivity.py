"""Contract of connectivity: fixed exactly where every frame has the same faces over the same vertices."""

import numpy as np
import pytest

from kinetree.pipeline import views
from kinetree.schemas.input.connectivity import Connectivity
from kinetree.schemas.input.mesh import Cleaning, Mesh
from kinetree.tasks.input.connectivity import connectivity

V = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
F = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]], dtype=np.int32)


def frame(vertices=V, faces=F, origin=None):
    back = np.arange(len(vertices)) if origin is None else np.array(origin)
    return Mesh(vertices=vertices, faces=faces, vertex_of_input=back, cleaning=Cleaning())


def test_moving_vertices_under_the_same_faces_are_fixed():
    result = connectivity({t: frame(V * (t + 1)) for t in range(4)})
    assert result == Connectivity(fixed=True, first_change=None, vertices=4, faces=4)


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
    result = connectivity({10: frame(), 12: frame(V * 2), 14: other, 16: frame()})
    assert (result.fixed, result.first_change) == (False, 14)


def test_the_one_frame_that_keeps_a_sequence_from_being_fixed_is_told_with_its_reason():
    merged = Mesh(vertices=V[:3], faces=F[:1], vertex_of_input=np.array([0, 1, 2, 2]), cleaning=Cleaning(merged=1))
    result = connectivity({10: merged, 12: frame(), 14: frame(V * 2), 16: frame(V * 3)})
    assert not result.fixed
    assert [(o.frame, o.welded, o.vertices, o.faces) for o in result.odd] == [(10, 1, -1, -3)]
    (said,) = views.remarks(result)
    assert "frame 10 does not: 1 of its vertices lies on another one and was merged with it (mesh.merge)" in said


@pytest.mark.parametrize(
    ("other", "why"),
    [
        (frame(origin=[0, 1, 2, 3, -1]), "its file has 1 vertex more"),
        (frame(faces=F[:2]), "after cleaning it has 0 vertices more and 2 faces fewer"),
        (frame(faces=F[::-1]), "its faces join other vertices, or are in another order"),
    ],
    ids=["another file", "fewer faces", "another order"],
)
def test_what_differs_is_told_in_words(other, why):
    result = connectivity({0: frame(), 1: frame(V * 2), 2: frame(V * 3), 3: other, 4: other})
    (said,) = views.remarks(result)
    assert f"frame 3 (and 1 other frame) does not: {why};" in said


def test_a_sequence_surfaced_anew_in_every_frame_says_nothing_of_fixed_connectivity():
    result = connectivity({t: frame(faces=np.roll(F, t, axis=0)) for t in range(4)})
    assert (result.fixed, result.odd, views.remarks(result)) == (False, (), ())


def test_change_is_seen_against_the_first_frame():
    result = connectivity({0: frame(faces=F[:3]), 1: frame(), 2: frame()})
    assert (result.fixed, result.first_change, result.vertices, result.faces) == (False, 1, 4, 3)


def test_one_frame_alone_moves_nothing_and_is_not_fixed():
    result = connectivity({5: frame()})
    assert (result.fixed, result.first_change) == (False, None)
