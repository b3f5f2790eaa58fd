"""The reference of one interval, as the task gives it."""

import numpy as np
import pytest
import trimesh
from sheets import CORNERS, TRACKED, frame, reference_of


def test_reference_is_the_middle_frame_with_its_leaves_and_their_coordinates() -> None:
    frames = {t: frame(t) for t in range(10, 19)}
    reference = reference_of(frames, 1, 3, 8)
    assert (reference.frame, reference.frames) == (16, (14, 15, 16, 17, 18))
    here = frames[16]
    np.testing.assert_array_equal(reference.vertices, here.mesh.vertices)
    assert reference.leaf.tolist() == [0, 1, 2]
    assert reference.leaf_vertex.tolist() == here.number[CORNERS].tolist()
    assert (reference.coordinates[np.arange(3), reference.leaf_vertex] == 0).all()
    assert reference.size == pytest.approx(np.sqrt(13 * 8))


def test_leaves_are_the_extrema_of_every_frame_at_the_same_corners() -> None:
    frames = {t: frame(t) for t in range(10, 19)}
    reference = reference_of(frames, 1, 3, 8)
    for position, t in enumerate(reference.frames):
        vertex = frames[t].extrema.vertices[reference.extremum[:, position]]
        assert vertex.tolist() == frames[t].number[CORNERS].tolist()


def test_neighbour_towards_the_reference_is_the_previous_frame() -> None:
    reference = reference_of({t: frame(t) for t in (3, 5, 7, 9)}, 0, 3)
    assert [reference.previous(t) for t in reference.frames] == [5, None, 5, 7]


def test_reference_sees_all_leaves_even_where_the_middle_does_not() -> None:
    frames = {t: frame(t, hidden=(1,) if t in (2, 3) else ()) for t in range(7)}
    reference = reference_of(frames, 0, 6)
    assert reference.frame == 4
    assert reference.extremum[1, [2, 3]].tolist() == [-1, -1]


def test_leaves_that_are_seldom_seen_are_none_of_the_interval() -> None:
    frames = {t: frame(t, hidden=(1,)) for t in range(3)}
    assert reference_of(frames, 0, 2).leaf.tolist() == [0, 2]
    bare = reference_of({t: frame(t, hidden=(0, 1, 2)) for t in range(3)}, 0, 2)
    assert bare.coordinates.shape[0] == 0


def test_fixed_connectivity_is_decided_here() -> None:
    frames = {t: frame(t, anew=False) for t in range(3)}
    assert reference_of(frames, 0, 2, connectivity=TRACKED).tracked
    assert not reference_of(frames, 0, 2).tracked


def test_leaves_of_fixed_connectivity_are_those_of_the_middle_frame_whatever_other_frames_see() -> None:
    frames = {t: frame(t, anew=False, hidden=(1,) if t != 3 else ()) for t in range(7)}
    assert reference_of(frames, 0, 6).leaf.tolist() != [0, 1, 2]
    reference = reference_of(frames, 0, 6, connectivity=TRACKED)
    assert reference.frame == 3
    assert reference.leaf_vertex.tolist() == frames[3].extrema.vertices.tolist()
    assert reference.coordinates.shape[0] == 3


def test_genus_is_that_of_a_closed_surface_and_nought_for_an_open_one() -> None:
    reference = reference_of({t: frame(t) for t in range(3)}, 0, 2)
    ring = trimesh.creation.torus(3.0, 1.0)
    assert reference.genus == 0
    assert reference.model_copy(update={"vertices": ring.vertices, "faces": ring.faces}).genus == 1
