"""Laws of an animated GLB: what moves is where glTF says it is, at the file's own rate; what is damaged is refused in words."""

import re
import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numerics.input.animated_glbs import KINDS, TENTHS, WIDTHS, F, GlbDraft, V

from kinetree.errors import MeshError, SourceError
from kinetree.tasks.numerics.input import animated_glb, unpacked
from kinetree.tasks.numerics.input.animated import read_animated
from kinetree.tasks.numerics.input.animated_glb import AnimatedGlb


def frames_of(glb, clip=""):
    return AnimatedGlb(glb.raw(), "walk.glb", clip)


def refusal(glb, clip=""):
    with pytest.raises(SourceError) as refused:
        frames_of(glb, clip).mesh(0)
    return str(refused.value)


def test_node_that_moves_is_read_at_the_rate_of_its_keys():
    frames = frames_of(GlbDraft().moves("translation", TENTHS / 3, np.outer(TENTHS, [1, 2, 3])))
    assert (len(frames), frames.fps, frames.unit) == (11, 30.0, "m")
    for t in (0, 4, 10):
        X, G = frames.mesh(t)
        np.testing.assert_allclose(X, V + t / 10 * np.array([1, 2, 3]), atol=1e-6)
        np.testing.assert_array_equal(G, F)


def test_keys_set_by_hand_are_read_at_24_frames_a_second():
    frames = frames_of(GlbDraft().moves("translation", [0, 1], [[0, 0, 0], [1, 0, 0]]))
    assert (len(frames), frames.fps) == (25, 24.0)
    np.testing.assert_allclose(frames.mesh(6)[0][0], [0.25, 0, 0], atol=1e-6)


def test_steps_hold_until_the_next_key():
    frames = frames_of(GlbDraft().moves("translation", [0, 1], [[0, 0, 0], [1, 0, 0]], way="STEP"))
    assert frames.mesh(23)[0][0, 0] == 0
    assert frames.mesh(24)[0][0, 0] == 1


def test_cubic_splines_follow_their_tangents():
    """A key is a tangent in, a value and a tangent out: 0 → 1 with tangents 0 is 3s² − 2s³."""
    keys = np.zeros((2, 3, 3))
    keys[1, 1, 0] = 1
    frames = frames_of(GlbDraft().moves("translation", [0, 1], keys.reshape(6, 3), way="CUBICSPLINE"))
    s = 6 / 24
    np.testing.assert_allclose(frames.mesh(6)[0][0], [3 * s**2 - 2 * s**3, 0, 0], atol=1e-6)


def test_rotations_take_the_shorter_way_round():
    half = np.sqrt(0.5)
    frames = frames_of(
        GlbDraft().moves("rotation", [0, 1], [[0, 0, 0, 1], [0, 0, -half, -half]])
    )  # +90° about z, written negatively
    angle = np.deg2rad(45)
    np.testing.assert_allclose(frames.mesh(12)[0][1], [np.cos(angle), np.sin(angle), 0], atol=1e-6)


def test_parents_carry_children_and_mirrors_keep_faces_outward():
    glb = GlbDraft()
    glb.document["nodes"] = [{"children": [1], "scale": [-1, 1, 1]}, {"mesh": 0, "translation": [0, 5, 0]}]
    X, G = frames_of(glb.moves("translation", [0, 1], [[0, 0, 0], [8, 0, 0]])).mesh(24)
    np.testing.assert_allclose(X, V * [-1, 1, 1] + [8, 5, 0], atol=1e-6)
    volume = np.einsum("fi,fi->", X[G[:, 0]], np.cross(X[G[:, 1]], X[G[:, 2]]))
    assert volume > 0


def test_morph_targets_are_added_by_their_weights_also_sparse_ones():
    glb = GlbDraft()
    rows, values = glb.view(np.array([2], np.uint16).tobytes()), glb.view(np.float32([[0, 0, 4]]).tobytes())
    apart = {"count": 1, "indices": {"bufferView": rows, "componentType": 5123}, "values": {"bufferView": values}}
    glb.document["accessors"].append({"componentType": 5126, "count": 4, "type": "VEC3", "sparse": apart})
    glb.primitive["targets"] = [{"POSITION": len(glb.document["accessors"]) - 1}, {"POSITION": glb.add(V)}]
    X, _ = frames_of(glb.moves("weights", [0, 1], [0, 0, 0.5, 1])).mesh(24)
    np.testing.assert_allclose(X, 2 * V + 0.5 * np.float32([[0, 0, 0], [0, 0, 0], [0, 0, 4], [0, 0, 0]]), atol=1e-6)


def test_a_frame_of_many_morph_targets_costs_its_own_alone():
    glb = GlbDraft()
    glb.primitive["targets"] = [*[{}] * 9999, {"POSITION": glb.add(V)}]
    frames = AnimatedGlb(glb.raw(), "walk.glb", targets_are_frames=True)
    tracemalloc.start()
    X, _ = frames.mesh(9999)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    np.testing.assert_allclose(X, 2 * V, atol=1e-6)
    assert peak < 10**6


@pytest.mark.parametrize(
    ("limit", "primitives", "words"),
    [
        ("_MOST_FRAMES", 1, r"20 morph targets, more than 10 frames; export a shorter segment"),
        ("_MOST_BYTES", 1, r"its morph targets unfold to 1920 bytes, more than 1900; export fewer"),
        ("_MOST_BYTES", 2, r"its morph targets unfold to 3840 bytes, more than 3000; export fewer"),
    ],
    ids=["frames", "bytes", "bytes of all primitives"],
)
def test_morph_targets_without_bound_are_refused(monkeypatch, limit, primitives, words):
    glb = GlbDraft()
    glb.primitive["targets"] = [{}] * 20
    glb.document["meshes"][0]["primitives"] *= primitives
    monkeypatch.setattr(animated_glb, limit, {"_MOST_FRAMES": 10}.get(limit, 1900 if primitives == 1 else 3000))
    with pytest.raises(SourceError, match=words):
        AnimatedGlb(glb.raw(), "walk.glb", targets_are_frames=True)


def zeros(glb, count, width, kind=5121):
    """An accessor that takes no bytes of the file."""
    glb.document["accessors"].append({"componentType": kind, "count": count, "type": WIDTHS[width]})
    return len(glb.document["accessors"]) - 1


def skinned(glb, vertices):
    influences = zeros(glb, vertices, 4)
    attributes = {f"{kind}_{k}": influences for kind in ("JOINTS", "WEIGHTS") for k in range(8)}
    glb.primitive["attributes"] = {"POSITION": zeros(glb, vertices, 3, KINDS["f4"]), **attributes}
    glb.document["skins"] = [{"joints": [0]}]
    glb.document["nodes"][0]["skin"] = 0


def of_many_primitives(glb, corners):
    glb.primitive["indices"] = zeros(glb, corners, 1, KINDS["u4"])
    glb.document["meshes"][0]["primitives"] *= 20


def morphed(glb, vertices):
    glb.primitive["targets"] = [{"POSITION": zeros(glb, vertices, 3, KINDS["f4"])}] * 20


def keyed(glb, weights):
    sampler = {"input": glb.add(np.float32([0])), "output": zeros(glb, weights, 1)}
    channels = [{"sampler": 0, "target": {"node": 0, "path": "weights"}}] * 20
    glb.document["animations"].insert(0, {"name": "still", "samplers": [sampler], "channels": channels})


@pytest.mark.parametrize("unfold", [skinned, of_many_primitives, morphed, keyed])
def test_arrays_that_take_no_bytes_of_the_file_are_held_against_them_all_together(monkeypatch, unfold):
    assert unpacked.UNPACKED_BYTES == 2**28
    monkeypatch.setattr(unpacked, "UNPACKED_BYTES", 10**6)
    glb = GlbDraft().moves("translation", [0, 1], [[0, 0, 0], [1, 0, 0]])
    unfold(glb, 30_000)
    assert re.search(r"^walk\.glb: its arrays: \d+ bytes would unpack to 1\d{6}; expected at most 100 times", refusal(glb))


def test_skin_moves_vertices_with_their_joints_and_not_with_their_node():
    glb = GlbDraft()
    glb.document["nodes"] = [{"mesh": 0, "skin": 0, "translation": [9, 9, 9]}, {"translation": [0, 0, 1], "children": [2]}, {}]
    glb.document["scenes"] = [{"nodes": [0, 1]}]
    back = np.eye(4, dtype=np.float32)
    back[3, :3] = [0, 0, -1]  # columns first
    glb.document["skins"] = [{"joints": [1, 2], "inverseBindMatrices": glb.add(np.tile(back.reshape(1, 16), (2, 1)))}]
    joints = np.array([[0, 1, 0, 0]] * 4, dtype=np.uint8)
    weights = np.array([[255, 0, 0, 0], [0, 255, 0, 0], [128, 127, 0, 0], [0, 0, 0, 0]], dtype=np.uint8)
    glb.primitive["attributes"] |= {"JOINTS_0": glb.add(joints), "WEIGHTS_0": glb.add(weights, normalized=True)}
    X, _ = frames_of(glb.moves("translation", [0, 1], [[0, 0, 0], [2, 0, 0]], node=2)).mesh(24)
    half = 127 / 255
    np.testing.assert_allclose(X, V + np.array([[0, 0, 0], [2, 0, 0], [2 * half, 0, 0], [0, 0, 0]]), atol=1e-6)


def test_one_of_several_clips_is_chosen_by_name():
    glb = GlbDraft().moves("translation", [0, 1], [[0, 0, 0], [1, 0, 0]])
    glb.moves("translation", [0, 2], [[0, 0, 0], [0, 0, 7]], name="wave")
    assert len(frames_of(glb)) == 25
    assert frames_of(glb, "wave").mesh(48)[0][0, 2] == 7
    assert "source.clip dance: there is walk, wave" in refusal(glb, "dance")


def test_what_is_no_animated_surface_is_refused_in_words():
    assert "one mesh without animation" in refusal(GlbDraft())
    still = GlbDraft().moves("translation", [0, 1], [[0, 0, 0], [1, 0, 0]], node=4)
    assert "moves nothing that is shown" in refusal(still)
    points = GlbDraft().moves("translation", [0, 1], [[0, 0, 0], [1, 0, 0]])
    points.primitive["mode"] = 0
    assert "shows no triangles" in refusal(points)
    endless = GlbDraft().moves("translation", [0, 1e9], [[0, 0, 0], [1, 0, 0]])
    assert "export a shorter clip" in refusal(endless)
    round_about = GlbDraft().moves("translation", [0, 1], [[0, 0, 0], [1, 0, 0]])
    round_about.document["nodes"][0]["children"] = [0]
    assert "no tree" in refusal(round_about)
    large = GlbDraft().moves("translation", [0, 1], [[0, 0, 0], [1, 0, 0]])
    large.document["accessors"][0]["count"] = 10**8
    assert "too large a layout" in refusal(large)
    packed = GlbDraft().moves("translation", [0, 1], [[0, 0, 0], [1, 0, 0]])
    packed.document["extensionsRequired"] = ["KHR_draco_mesh_compression"]
    assert "export it uncompressed" in refusal(packed)


@given(st.lists(st.tuples(st.integers(0, 2**31), st.integers(0, 255)), min_size=1, max_size=6))
@settings(max_examples=300, deadline=None)
def test_damaged_files_are_refused_or_read_and_nothing_else(tmp_path_factory, damage):
    raw = bytearray(GlbDraft().moves("rotation", [0, 1], [[0, 0, 0, 1], [0, 0, 1, 0]]).raw())
    for at, byte in damage:
        raw[at % len(raw)] = byte
    path = tmp_path_factory.getbasetemp() / "damaged.glb"
    path.write_bytes(raw)
    try:
        frames = read_animated(path)
        frames.mesh(len(frames) - 1)
    except (SourceError, MeshError) as error:
        message = str(error)
    else:
        message = str(path)
    assert str(path) in message
