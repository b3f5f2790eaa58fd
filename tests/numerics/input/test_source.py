"""Laws of listing and of packed sequences: natural order, frames as they were stacked, the words of every refusal."""

import os
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinetree.errors import MeshError, SourceError
from kinetree.tasks.numerics.input.source import Frames, mesh_files, natural_order, read_npz

V = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [7, 7, 7]], dtype=float)  # nobody refers to the last one
F = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]], dtype=np.int32)


def written(tmp_path, name, content):
    path = tmp_path / name
    path.write_bytes(content)
    return path


# ── listing ─────────────────────────────────────────────────────────────────────────────────────────────────────────


@given(st.lists(st.integers(0, 10**6), unique=True), st.text(st.characters(exclude_categories=["Nd"]), max_size=5))
def test_numbered_names_come_in_the_order_of_their_numbers(numbers, stem):
    names = [f"{stem}{n}.ply" for n in numbers]
    assert sorted(names, key=natural_order) == [f"{stem}{n}.ply" for n in sorted(numbers)]


@given(st.lists(st.text("aB_.-0129²", max_size=8), unique=True), st.randoms())
def test_order_of_names_does_not_depend_on_the_order_they_were_found_in(names, random):
    shuffled = random.sample(names, len(names))
    assert sorted(shuffled, key=natural_order) == sorted(names, key=natural_order)


def test_folder_lists_its_meshes_in_natural_order_and_passes_over_the_rest(tmp_path):
    for name in ("frame_10.ply", "frame_2.ply", "frame_1.PLY", ".hidden.ply", "truth.json", "skin.png"):
        written(tmp_path, name, b"")
    (tmp_path / "folder").mkdir()
    assert [p.name for p in mesh_files(tmp_path)] == ["frame_1.PLY", "frame_2.ply", "frame_10.ply"]
    assert [p.name for p in mesh_files(str(tmp_path))] == ["frame_1.PLY", "frame_2.ply", "frame_10.ply"]


def dangling(path):
    path.symlink_to("nowhere.ply")


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (dangling, "a link to nowhere.ply, which is not there"),
        (Path.mkdir, "a folder"),
        (os.mkfifo, "neither a file nor a folder"),
    ],
)
@pytest.mark.parametrize("pattern", ["", "*.ply", "f*"])
def test_what_is_no_file_under_the_name_of_a_frame_is_refused_and_not_passed_over(tmp_path, make, words, pattern):
    for name in ("f0.ply", "f2.ply"):
        written(tmp_path, name, b"")
    make(tmp_path / "f1.ply")
    with pytest.raises(SourceError, match=rf"f1\.ply: {words}.*; put the frame's file there, or take the name away"):
        mesh_files(tmp_path / pattern)


def test_link_to_a_file_is_a_file(tmp_path):
    written(tmp_path, "f0.ply", b"")
    (tmp_path / "f1.ply").symlink_to("f0.ply")
    assert len(mesh_files(tmp_path)) == 2


def test_pattern_lists_what_it_matches_across_folders(tmp_path):
    for take in ("take_10", "take_9"):
        (tmp_path / take).mkdir()
        for name in ("a_1.obj", "a_2.obj", "b_1.obj", "notes.txt"):
            written(tmp_path / take, name, b"")
    found = mesh_files(tmp_path / "take_*" / "a_*")
    assert [f"{p.parent.name}/{p.name}" for p in found] == [
        "take_9/a_1.obj",
        "take_9/a_2.obj",
        "take_10/a_1.obj",
        "take_10/a_2.obj",
    ]


def test_folder_whose_name_looks_like_a_pattern_is_a_folder(tmp_path):
    (tmp_path / "take[1]").mkdir()
    written(tmp_path / "take[1]", "0.stl", b"")
    assert len(mesh_files(tmp_path / "take[1]")) == 1


def test_missing_folder_is_refused_with_the_name_it_may_have_meant(tmp_path):
    (tmp_path / "walking").mkdir()
    with pytest.raises(SourceError, match=r"walkin: there is no such folder; there is .*walking$"):
        mesh_files(tmp_path / "walkin")
    with pytest.raises(SourceError, match=r"walk\.GLB: there is no such file; the nearest folder"):
        mesh_files(tmp_path / "walk.GLB")
    with pytest.raises(SourceError, match=rf"no such folder; the nearest folder that exists is {tmp_path}$"):
        mesh_files(tmp_path / "xyz" / "deeper")


def test_folder_without_meshes_is_refused_with_what_was_there(tmp_path):
    with pytest.raises(SourceError, match=r"no mesh among its files \(nothing\); .ply .obj .off .stl .glb .drc are read"):
        mesh_files(tmp_path)
    for name in ("a.fbx", "b.fbx", "readme"):
        written(tmp_path, name, b"")
    with pytest.raises(SourceError, match=r"\(1 × no suffix, 2 × .fbx\)"):
        mesh_files(tmp_path)
    with pytest.raises(SourceError, match=r"matches of .*\*\.ply: no mesh among its files \(nothing\)"):
        mesh_files(tmp_path / "*.ply")


def test_several_formats_are_refused_with_counts_and_a_pattern(tmp_path):
    for name in ("1.ply", "2.ply", "1.obj"):
        written(tmp_path, name, b"")
    with pytest.raises(SourceError, match=r"several formats \(1 × .obj, 2 × .ply\); choose by a pattern .*\*\.ply$"):
        mesh_files(tmp_path)
    assert len(mesh_files(tmp_path / "*.ply")) == 2


def test_single_file_is_refused_as_a_sequence(tmp_path):
    path = written(tmp_path, "body.ply", b"one frame, whatever is in it")
    with pytest.raises(SourceError, match=r"body.ply: one file, not a sequence; give the folder"):
        mesh_files(path)


@pytest.mark.parametrize("packed", ["f1.ply.gz", "f1.PLY.GZ", "f1.obj.zip", "f1.off.xz"])
def test_packed_mesh_is_refused_with_the_remedy_instead_of_passed_over(tmp_path, packed):
    written(tmp_path, packed, b"")
    for other in ((), ("f0.ply", "f2.ply")):
        for name in other:
            written(tmp_path, name, b"")
        with pytest.raises(SourceError, match=f"{packed} is packed; unpack it first, for instance with gunzip or unzip"):
            mesh_files(tmp_path)


def test_packed_files_beside_their_unpacked_ones_and_other_archives_are_passed_over(tmp_path):
    for name in ("f0.ply", "f0.ply.gz", "textures.zip", "notes.txt.gz"):
        written(tmp_path, name, b"")
    assert [path.name for path in mesh_files(tmp_path)] == ["f0.ply"]


# ── reading ─────────────────────────────────────────────────────────────────────────────────────────────────────────


def sequence(fixed=False):
    frames = [(V + t, F[: 4 - t * (not fixed)]) for t in range(3)]
    if not fixed:
        frames = [(X[: 5 - (t == 1)], G) for t, (X, G) in enumerate(frames)]
    faces = [F] if fixed else [G for _, G in frames]
    arrays = {
        "vertices": np.concatenate([X for X, _ in frames]).astype(np.float32),
        "faces": np.concatenate(faces),
        "vertex_offsets": np.cumsum([0] + [len(X) for X, _ in frames]),
        "face_offsets": np.cumsum([0] + [len(G) for G in faces]),
        "fps": np.array(25.0),
        "unit": np.array("mm"),
    }
    return frames, arrays


@pytest.mark.parametrize("fixed", [False, True])
def test_frames_come_back_as_they_were_stacked(tmp_path, fixed):
    expected, arrays = sequence(fixed)
    np.savez_compressed(tmp_path / "a.npz", **arrays, weights=np.ones(3))
    frames = read_npz(tmp_path / "a.npz")
    assert (len(frames), frames.fps, frames.unit) == (3, 25.0, "mm")
    for t, (X, G) in enumerate(expected):
        read_V, read_F = frames.mesh(t)
        np.testing.assert_array_equal(read_V, X)
        np.testing.assert_array_equal(read_F, G)
        assert (read_V.dtype, read_F.dtype) == (np.float64, np.int32)


def test_rate_and_unit_may_be_missing():
    _, arrays = sequence()
    frames = Frames.of({key: arrays[key] for key in arrays if key not in ("fps", "unit")}, "a")
    assert frames.fps is None
    assert frames.unit is None
    assert Frames.of(arrays | {"unit": np.array("unknown")}, "a").unit is None


def test_what_a_caller_does_to_a_frame_does_not_reach_the_next_caller():
    frames = Frames.of(sequence()[1], "a")
    frames.mesh(0)[0][:] = 9
    frames.mesh(0)[1][:] = 0
    np.testing.assert_array_equal(frames.mesh(0)[0], V)
    np.testing.assert_array_equal(frames.mesh(0)[1], F)


def test_file_is_unpacked_once_until_it_changes(tmp_path):
    _, arrays = sequence()
    np.savez_compressed(tmp_path / "a.npz", **arrays)
    frames = read_npz(tmp_path / "a.npz")
    assert read_npz(tmp_path / "a.npz") is frames
    arrays["vertices"] = arrays["vertices"] + 1
    np.savez(tmp_path / "a.npz", **arrays)
    np.testing.assert_array_equal(read_npz(tmp_path / "a.npz").mesh(0)[0], V + 1)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"faces": None, "vertex_offsets": None}, "no array faces, vertex_offsets; there are face_offsets, fps, unit, vert"),
        ({"vertices": np.zeros((14, 2))}, r"vertices is float64 \(14, 2\); floating numbers \(n, 3\) are needed"),
        ({"vertices": np.zeros((14, 3), complex)}, r"vertices is complex128 \(14, 3\)"),
        ({"faces": np.zeros((9, 3))}, r"faces is float64 \(9, 3\); whole numbers \(n, 3\) are needed"),
        ({"vertex_offsets": np.array([0.0, 5, 9, 14])}, r"vertex_offsets is float64 \(4,\); whole numbers \(frame \+ 1,\)"),
        ({"vertex_offsets": np.array([0])}, r"vertex_offsets is int64 \(1,\)"),
        ({"vertex_offsets": np.array([0, 9, 5, 14])}, "vertex_offsets must increase, but 5 follows 9 after frame 1"),
        ({"vertex_offsets": np.array([0, 5, 9, 15])}, "run from 0 to 15, but there are 14 vertices"),
        ({"face_offsets": np.array([-1, 4, 7, 9])}, "face_offsets run from -1 to 9, but there are 9 faces"),
        ({"face_offsets": np.array([0, 4, 9])}, "vertex_offsets are of 3 frames, face_offsets of 2; they must agree"),
        ({"face_offsets": np.array([0, 9])}, "one set of faces for all frames, but frames differ"),
        ({"fps": np.array(0.0)}, "fps is 0.0; one positive number"),
        ({"fps": np.array("fast")}, "fps is fast; one positive number"),
    ],
)
def test_arrays_that_make_no_sequence_are_refused_with_what_is_wrong(change, words):
    arrays = {key: array for key, array in (sequence()[1] | change).items() if array is not None}
    with pytest.raises(SourceError, match=words) as refused:
        Frames.of(arrays, "walk.npz")
    assert str(refused.value).startswith("walk.npz: ")


def test_bad_frame_is_refused_by_its_number_and_a_frame_that_is_not_there_too():
    _, arrays = sequence()
    arrays["faces"][5] = 77
    frames = Frames.of(arrays, "walk.npz")
    frames.mesh(0)
    with pytest.raises(MeshError, match=r"walk.npz, frame 1: vertex 0 of face 1 is 77, but the mesh has 4 vertices"):
        frames.mesh(1)
    for t in (3, -1):
        with pytest.raises(SourceError, match=rf"there is no frame {t}; frames are 0 to 2"):
            frames.mesh(t)


def test_archive_is_never_unpickled(tmp_path):
    class Trap:
        def __reduce__(self):
            return os.mkdir, (str(tmp_path / "sprung"),)

    arrays = sequence()[1] | {"vertices": np.array([Trap()], dtype=object)}
    np.savez(tmp_path / "a.npz", **arrays)
    with pytest.raises(SourceError, match=r"a.npz: cannot be read as .npz \(ValueError: Object arrays"):
        read_npz(tmp_path / "a.npz")
    assert not (tmp_path / "sprung").exists()


def test_what_is_no_archive_is_refused(tmp_path):
    with pytest.raises(SourceError, match="there is no such file"):
        read_npz(tmp_path / "a.npz")
    with pytest.raises(SourceError, match=r"a.npz: cannot be read as .npz"):
        read_npz(written(tmp_path, "a.npz", b"PK\x03\x04 and no more"))
