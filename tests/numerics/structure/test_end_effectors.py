"""Where bones end."""

import numpy as np
from articulated import chain

from kinetree.tasks.numerics.structure.end_effectors import end_effectors, leaf_vertices

NONE = np.zeros(0, dtype=np.int64)


def test_last_part_without_a_leaf_ends_where_it_is_farthest() -> None:
    body = chain((-2.0, 2.0))
    ends = end_effectors(body.V, body.F, body.label, body.parents, NONE)
    assert ends.tolist() == [[2, int(np.argmax(body.V[:, 2]))]]


def test_leaves_are_ends_wherever_they_are() -> None:
    body = chain((-2.0, 2.0))
    low, middle = int(np.argmin(body.V[:, 2])), int(np.argmin(np.abs(body.V[:, 2])))
    near = int(np.argmin(np.abs(body.V[:, 2] - 3.0)))
    far = int(np.argmax(body.V[:, 2]))
    ends = end_effectors(body.V, body.F, body.label, body.parents, np.array([near, low, far, middle]))
    assert ends.tolist() == [[0, low], [1, middle], [2, far], [2, near]]


def test_body_of_one_part_ends_nowhere_but_in_its_leaves() -> None:
    body = chain((0.0,))
    one, root = np.zeros(len(body.V), dtype=np.int64), np.array([-1])
    assert end_effectors(body.V, body.F, one, root, NONE).shape == (0, 2)
    assert end_effectors(body.V, body.F, one, root, np.array([5])).tolist() == [[0, 5]]


SEEN = np.array([[0, 1], [-1, 0], [2, -1], [1, 2]])
"""(leaf, frame) extrema of two frames that show three leaves each."""


def test_leaves_that_are_seen_are_at_the_nearest_vertices() -> None:
    V = np.eye(3)
    positions = np.array([[0.9, 0.0, 0.1], [np.nan] * 3, [0.0, 0.0, 1.1], [0.0, 1.0, 0.0]])
    none = np.zeros((1, 4), np.bool_)
    assert leaf_vertices(V, positions, SEEN, 0, none).tolist() == [0, 2, 1]
    assert leaf_vertices(V, positions[:0], SEEN[:0], 0, none[:, :0]).tolist() == []


def test_where_one_frame_alone_shows_so_many_leaves_those_alone_count_that_count_in_an_interval() -> None:
    V, counts = np.eye(3), np.array([[True, True, False, False], [False, True, False, True]])
    for frames, others in ((2, 0), (30, 1), (30, 2)):
        extrema = np.tile([[0], [1], [-1], [2]], frames)
        extrema[2, 0] = 3
        extrema[2, 1 : 1 + others] = 3
        found = leaf_vertices(V, np.eye(3)[[0, 1, 2, 2]], extrema, 0, counts).tolist()
        assert found == ([0, 1, 2, 2] if others == 2 else [0, 1, 2])
