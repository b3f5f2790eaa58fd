"""Laws of areas, joints and bones."""

import numpy as np
from limbs import tube

from kinetree.tasks.numerics.paper_2014.bones import adjacent, areas, bodies, candidates, variation, without_redundant
from kinetree.tasks.numerics.paper_2014.cylinders import Piece

V, F = tube()
RING = np.minimum(((V[:, 2] + 5.0) / 1.0).astype(int), 9)


def marks(text):
    return np.array([c == "#" for c in text])


def test_contiguous_annuli_of_one_kind_are_one_area():
    found = areas([Piece(0, -1, RING, marks("##..###.##"))], len(V), F)
    assert found.rigid.tolist() == [True, False, True, False, True]
    assert found.first.tolist() == [0, 2, 4, 7, 8]
    assert found.last.tolist() == [1, 3, 6, 7, 9]
    assert (found.label == np.array([0, 0, 1, 1, 2, 2, 2, 3, 4, 4])[RING]).all()


def test_what_no_piece_has_goes_to_the_area_beside_it():
    ring = np.where(RING == 5, -1, RING)
    found = areas([Piece(0, -1, ring, marks("#####.####"))], len(V), F)
    assert (found.label >= 0).all()
    assert found.rigid.all()


def test_no_pieces_are_one_rigid_area():
    found = areas([], len(V), F)
    assert (found.label == 0).all()
    assert found.rigid.tolist() == [True]


def test_rigid_areas_without_a_joint_between_them_are_one_body():
    low, high = np.where(RING < 4, RING, -1), np.where(RING >= 4, RING - 4, -1)
    found = areas([Piece(0, -1, low, marks("#.##")), Piece(1, -1, high, marks("##.###"))], len(V), F)
    meets = adjacent(found.label, F, len(found.rigid))
    assert found.rigid.tolist() == [True, False, True, True, False, True]
    assert bodies(meets, found.rigid).tolist() == [0, -1, 1, 1, -1, 2]


def test_bones_join_joints_of_one_body_and_joints_that_touch():
    found = areas([Piece(0, -1, RING, marks("##.##.##.#"))], len(V), F)
    meets = adjacent(found.label, F, len(found.rigid))
    pair, carrier = candidates(meets, bodies(meets, found.rigid))
    assert pair.tolist() == [[1, 3], [3, 5]]
    assert carrier.tolist() == [1, 2]
    low, high = np.where(RING < 5, RING, -1), np.where(RING >= 5, RING - 5, -1)
    found = areas([Piece(0, -1, low, marks("####.")), Piece(1, -1, high, marks(".####"))], len(V), F)
    meets = adjacent(found.label, F, len(found.rigid))
    pair, carrier = candidates(meets, bodies(meets, found.rigid))
    assert pair.tolist() == [[1, 2]]
    assert carrier.tolist() == [-1]


def test_body_of_joints_alone_and_body_without_joints_have_what_they_have():
    none = np.zeros((1, 1), bool)
    assert bodies(none, np.array([True])).tolist() == [0]
    assert bodies(none, np.array([False])).tolist() == [-1]
    assert len(candidates(none, np.array([-1]))[0]) == 0
    assert len(candidates(none, np.array([0]))[0]) == 0


def test_spanning_tree_drops_the_bone_of_a_triangle_whose_length_varies_most():
    t = np.linspace(0.0, 1.0, 9)
    a, b = np.zeros((9, 3)), np.zeros((9, 3))
    b[:, 0] = 2.0
    c = np.stack([2.0 + np.sin(t), np.cos(t), 0 * t], axis=1)  # keeps its distance from b, not from a
    pair = np.array([[0, 1], [0, 2], [1, 2]])
    X = np.stack([a, b, c], axis=1)
    assert without_redundant(X, pair).tolist() == [0, 2]
    assert variation(X, pair)[[0, 2]].max() < 1e-12


def test_frames_in_which_a_joint_is_not_seen_do_not_count():
    X = np.zeros((4, 2, 3))
    X[:, 1, 0] = [1.0, 1.0, np.nan, 1.0]
    assert variation(X, np.array([[0, 1]])).tolist() == [0.0]
    X[:, 1, 0] = np.nan
    assert variation(X, np.array([[0, 1]])).tolist() == [np.inf]
