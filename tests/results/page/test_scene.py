"""The scene of the player: positions are exact to half a step of the lattice, labels follow the vertices."""

import zlib

import numpy as np
import pytest
from results.rigged_bodies import skinned, spider
from results.sample_report import playing

from kinetree.tasks.results.page.scene import Limits
from kinetree.tasks.results.plots.drawing import view


def unpacked(scene):
    raw = zlib.decompress(scene.block)
    return {
        name: np.frombuffer(raw, a["dtype"], int(np.prod(a["shape"])), a["offset"]).reshape(a["shape"])
        for name, a in scene.description["arrays"].items()
    }


@pytest.fixture(scope="module")
def scene():
    return playing()


def test_aligned_mesh_and_joints_are_where_they_were_seen_along_the_views_axes(scene):
    skeleton, arrays = spider(), unpacked(scene)
    x = skinned(skeleton)
    axes = view(list(x))
    positions = np.array(scene.description["low"]) + scene.description["scale"] * arrays["positions"].astype(np.float64)
    assert np.abs(positions - x @ axes).max() <= 0.5 * scene.description["scale"] * (1 + 1e-9)
    np.testing.assert_allclose(arrays["joints"], skeleton.positions @ axes, atol=1e-5)


def test_labels_come_back_to_the_users_own_vertices(scene):
    arrays = unpacked(scene)
    order = np.random.default_rng(0).permutation(len(spider().vertices))
    first = arrays["input_label"][: arrays["input_vertex_offsets"][1]]
    np.testing.assert_array_equal(first, spider().label[order])


def test_faces_of_every_input_mesh_stay_among_its_own_vertices(scene):
    arrays = unpacked(scene)
    v = arrays["input_vertex_offsets"].astype(int)
    for t, (begin, end) in enumerate(arrays["input_face_spans"].astype(int)):
        assert 0 <= arrays["input_faces"][begin:end].min() <= arrays["input_faces"][begin:end].max() < v[t + 1] - v[t]


@pytest.mark.parametrize("limits", [None, Limits(frames=5, vertices=100, input_vertices=100)])
def test_faces_that_stay_the_same_are_held_once(limits):
    arrays = unpacked(playing(limits=limits))
    assert len(arrays["input_face_spans"]) > 1
    assert (arrays["input_face_spans"] == [0, len(arrays["input_faces"])]).all()


def test_faces_that_change_are_held_for_every_frame():
    arrays = unpacked(playing(anew=True))
    spans = arrays["input_face_spans"].astype(int)
    assert (spans[1:, 0] == spans[:-1, 1]).all()
    assert spans[-1, 1] == len(arrays["input_faces"])
    for t, (begin, end) in enumerate(spans):
        v = arrays["input_vertex_offsets"].astype(int)[t : t + 2]
        assert arrays["input_faces"][begin:end].max() == v[1] - v[0] - 1


def test_what_is_left_out_is_said():
    small = playing(limits=Limits(frames=5, vertices=100, input_vertices=100))
    assert small.description["frames"] == [0, 3, 6, 8, 11]
    text = " ".join(small.omitted)
    assert "the player shows 5 of 12 frames" in text
    assert "input meshes are shown with about 100 of up to" in text
    assert len(playing().omitted) == 0


def test_intervals_begin_at_the_shown_frames_they_name(scene):
    assert scene.description["intervals"] == [{"at": 0, "begin": 0, "end": 5}, {"at": 6, "begin": 6, "end": 11}]


def test_leaves_that_are_not_known_stay_unknown(scene):
    leaves = unpacked(scene)["leaves"]
    assert np.isnan(leaves[6:, 0]).all()
    assert np.isfinite(leaves[:6]).all()
