"""Laws of dropping faces that are no piece of surface."""

import numpy as np

from kinetree.tasks.numerics.input.whole_faces import whole_faces

SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)
HALVES = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)


def test_a_mesh_of_whole_faces_stays_as_it_is():
    faces = whole_faces(SQUARE, HALVES, 0.05)
    np.testing.assert_array_equal(faces.origin, [0, 1])
    np.testing.assert_allclose(faces.area, 0.5)
    assert faces[2:] == (0, 0, 0)


def test_faces_of_two_corners_and_repeated_faces_are_dropped_and_counted():
    faces = whole_faces(SQUARE, np.concatenate([[[3, 3, 1]], HALVES, [[2, 0, 1]]]).astype(np.int32), 0.05)
    np.testing.assert_array_equal(faces.origin, [1, 2])
    assert (faces.degenerate, faces.duplicate, faces.folded) == (1, 1, 0)


def test_faces_back_to_back_go_in_pairs_unless_they_are_a_sheet():
    F = np.concatenate([HALVES, HALVES[1:, ::-1]])
    fin, sheet = whole_faces(SQUARE, F, 0.9), whole_faces(SQUARE, F, 0.05)
    np.testing.assert_array_equal(fin.origin, [0])
    assert (fin.duplicate, fin.folded) == (0, 2)
    np.testing.assert_array_equal(sheet.origin, [0, 1])
    assert (sheet.duplicate, sheet.folded) == (1, 0)
