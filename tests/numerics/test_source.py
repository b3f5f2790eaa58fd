"""Laws of listing and reading: natural order, vertices exactly as in the file, and the words of every refusal."""

import json
import os
import struct

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from kinetree.pipeline.errors import MeshError, SourceError
from kinetree.tasks.numerics.source import Frames, mesh_files, natural_order, read_mesh, read_npz

V = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [7, 7, 7]], dtype=float)  # nobody refers to the last one
F = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]], dtype=np.int32)


def ply(V=V, F=F, form="binary_little_endian", claimed=None):
    mark = {"binary_little_endian": "<", "binary_big_endian": ">", "ascii": ""}[form]
    head = f"ply\nformat {form} 1.0\nelement vertex {claimed or len(V)}\n" + "".join(f"property double {x}\n" for x in "xyz")
    head += f"element face {len(F)}\nproperty list uchar int vertex_indices\nend_header\n"
    if form == "ascii":
        rows = [" ".join(map(repr, map(float, v))) for v in V] + [" ".join(map(str, [len(f), *f])) for f in F]
        return (head + "\n".join(rows) + "\n").encode()
    faces = b"".join(struct.pack(f"{mark}B{len(f)}i", len(f), *map(int, f)) for f in F)
    return head.encode() + np.asarray(V).astype(f"{mark}f8").tobytes() + faces


def obj(V=V, F=F):
    rows = [f"v {x} {y} {z}" for x, y, z in V] + ["f " + " ".join(str(i + 1) for i in f) for f in F]
    return ("\n".join(rows) + "\n").encode()


def off(V=V, F=F):
    rows = [f"{x} {y} {z}" for x, y, z in V] + [" ".join(map(str, [len(f), *f])) for f in F]
    return (f"OFF\n{len(V)} {len(F)} 0\n" + "\n".join(rows) + "\n").encode()


def glb(header, body=b""):
    text = json.dumps(header).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text
    chunks += struct.pack("<I4s", len(body), b"BIN\0") + body if body else b""
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def written(tmp_path, name, content):
    path = tmp_path / name
    path.write_bytes(content)
    return path


def refusal(path):
    with pytest.raises(MeshError) as refused:
        read_mesh(path)
    message = str(refused.value)
    assert message.startswith(f"{path}: ")
    return message


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
    (tmp_path / "folder.ply").mkdir()
    assert [p.name for p in mesh_files(tmp_path)] == ["frame_1.PLY", "frame_2.ply", "frame_10.ply"]
    assert [p.name for p in mesh_files(str(tmp_path))] == ["frame_1.PLY", "frame_2.ply", "frame_10.ply"]


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
    with pytest.raises(SourceError, match=rf"no such folder; the nearest folder that exists is {tmp_path}$"):
        mesh_files(tmp_path / "xyz" / "deeper")


def test_folder_without_meshes_is_refused_with_what_was_there(tmp_path):
    with pytest.raises(SourceError, match=r"no mesh among its files \(nothing\); .ply .obj .off .stl .glb are read"):
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
    path = written(tmp_path, "body.ply", ply())
    with pytest.raises(SourceError, match=r"body.ply: one file, not a sequence; give the folder"):
        mesh_files(path)


# ── reading ─────────────────────────────────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("a.ply", ply()),
        ("a.ply", ply(form="binary_big_endian")),
        ("a.ply", ply(form="ascii")),
        ("a.obj", obj()),
        ("a.OFF", off()),
        ("a.off", b"# made by hand\nOFF 5 4 0\n" + off().split(b"\n", 2)[2]),
    ],
)
def test_vertices_and_faces_are_those_of_the_file(tmp_path, name, content):
    read_V, read_F = read_mesh(written(tmp_path, name, content))
    np.testing.assert_array_equal(read_V, V)
    np.testing.assert_array_equal(read_F, F)
    assert (read_V.dtype, read_F.dtype) == (np.float64, np.int32)
    assert read_V.flags.c_contiguous
    assert read_F.flags.c_contiguous


@given(st.lists(st.tuples(*[st.floats(width=64, allow_nan=False, allow_infinity=False)] * 3), min_size=1, max_size=20))
def test_coordinates_are_read_to_the_last_bit(tmp_path_factory, points):
    folder = tmp_path_factory.mktemp("bits")
    faces = np.zeros((1, 3), dtype=np.int32)
    for name, content in (("a.ply", ply(points, faces)), ("b.obj", obj(points, faces)), ("c.off", off(points, faces))):
        np.testing.assert_array_equal(read_mesh(written(folder, name, content))[0], points)


def test_obj_keeps_its_vertices_whatever_textures_normals_groups_and_relative_indices_say(tmp_path):
    text = b"""mtllib /etc/passwd
o one
v 0 0 0 1.0 0.5 0.5
v 1 0 0
v 1 1 0
vt 0 0
vt 1 1
vn 0 0 1
usemtl red
f 1/1/1 2/2/1 3/1/1
g two
v 0 1 0
usemtl blue
f -4//1 -2//1 \\
  -1//1
f 1/2 3/1 4
"""
    read_V, read_F = read_mesh(written(tmp_path, "a.obj", text))
    np.testing.assert_array_equal(read_V, [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    np.testing.assert_array_equal(read_F, [[0, 1, 2], [0, 2, 3], [0, 2, 3]])


@pytest.mark.parametrize(("name", "make"), [("a.obj", obj), ("a.off", off), ("a.ply", lambda F: ply(F=F, form="ascii"))])
def test_polygons_become_triangles_of_the_same_area(tmp_path, name, make):
    square = np.array([[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [1, 3, 0.0]])
    polygons = [[0, 1, 2, 3], [3, 2, 4], [0, 1, 2, 4, 3]]
    content = make(F=polygons).decode()
    for old, new in zip(V, square, strict=True):
        content = content.replace(" ".join(map(str, old)), " ".join(map(str, new)), 1)
    read_V, read_F = read_mesh(written(tmp_path, name, content.encode()))
    areas = trimesh.triangles.area(read_V[read_F])
    assert len(read_F) == 2 + 1 + 3
    assert areas.sum() == pytest.approx(4 + 1 + 5)


@pytest.mark.parametrize("form", ["stl", "stl_ascii"])
def test_stl_has_three_vertices_a_face_in_the_order_of_the_file(tmp_path, form):
    tetrahedron = trimesh.Trimesh(V[:4], F, process=False)
    content = tetrahedron.export(file_type=form)
    path = written(tmp_path, "a.stl", content.encode() if isinstance(content, str) else content)
    read_V, read_F = read_mesh(path)
    np.testing.assert_array_equal(read_V, V[F].reshape(-1, 3))
    np.testing.assert_array_equal(read_F, np.arange(12).reshape(4, 3))


def test_glb_puts_its_meshes_where_its_scene_says_and_mirrors_stay_outside_out(tmp_path):
    ball = trimesh.creation.icosphere(subdivisions=1)
    scene = trimesh.Scene()
    scene.add_geometry(ball, node_name="right", transform=trimesh.transformations.translation_matrix([3, 0, 0]))
    scene.add_geometry(ball, node_name="left", transform=np.diag([-2.0, 2, 2, 1]))
    read_V, read_F = read_mesh(written(tmp_path, "a.glb", scene.export(file_type="glb")))
    assert (len(read_V), len(read_F)) == (2 * len(ball.vertices), 2 * len(ball.faces))
    assert trimesh.Trimesh(read_V, read_F, process=False).volume == pytest.approx(9 * ball.volume, rel=1e-6)
    assert read_V[:, 0].max() == pytest.approx(4, rel=1e-6)


# ── refusals ────────────────────────────────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("name", ["a.ply", "a.obj", "a.off", "a.stl", "a.glb"])
def test_what_is_empty_garbage_or_missing_is_refused(tmp_path, name):
    assert "there is no such file" in refusal(tmp_path / name)
    assert "the file is empty" in refusal(written(tmp_path, name, b""))
    noise = np.random.default_rng(0).integers(0, 256, 500, dtype=np.uint8).tobytes()
    assert any(word in refusal(written(tmp_path, name, noise)) for word in ("damaged", "no vertices"))


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("a.ply", ply()),
        ("a.ply", ply(form="binary_big_endian")),
        ("a.ply", ply(form="ascii")),
        ("a.off", off()),
        ("a.stl", trimesh.creation.box().export(file_type="stl")),
        ("a.stl", trimesh.creation.box().export(file_type="stl_ascii").encode()),
        ("a.glb", trimesh.Scene(trimesh.creation.box()).export(file_type="glb")),
    ],
)
def test_file_cut_short_anywhere_is_refused(tmp_path, name, content):
    for share in (0.1, 0.3, 0.5, 0.7, 0.9):
        refusal(written(tmp_path, name, content[: int(share * len(content))]))


def test_other_formats_and_folders_are_refused(tmp_path):
    assert ".fbx is not read; .ply .obj .off .stl .glb are" in refusal(tmp_path / "a.fbx")
    (tmp_path / "a.ply").mkdir()
    assert "not a file" in refusal(tmp_path / "a.ply")


def test_pipe_is_refused_instead_of_waited_for(tmp_path):
    os.mkfifo(tmp_path / "a.ply")
    assert "not a file" in refusal(tmp_path / "a.ply")


@pytest.mark.parametrize(("name", "make"), [("a.ply", ply), ("a.obj", obj), ("a.off", off)])
def test_point_cloud_is_refused(tmp_path, name, make):
    assert "no faces, only 5 vertices; a surface is needed, not a point cloud" in refusal(written(tmp_path, name, make(F=[])))


@pytest.mark.parametrize(("name", "make"), [("a.ply", ply), ("a.off", off)])
def test_index_without_a_vertex_is_refused_with_its_place_and_the_likely_cause(tmp_path, name, make):
    wrong = F.copy()
    wrong[2, 1] = 5
    assert refusal(written(tmp_path, name, make(F=wrong))).endswith(
        "vertex 1 of face 2 is 5, but the mesh has 5 vertices; the file is damaged or its indices start at 1"
    )
    wrong[1, 0] = -2
    assert "vertex 0 of face 1 is -2, but the mesh has 5 vertices" in refusal(written(tmp_path, name, make(F=wrong)))


def test_index_without_a_vertex_in_obj_is_shown_as_the_file_has_it(tmp_path):
    wrong = F.copy()
    wrong[2, 1] = 5
    message = refusal(written(tmp_path, "a.obj", obj(F=wrong)))
    assert message.endswith("vertex 1 of face 2 is 6, but the mesh has 5 vertices; the file is damaged")


@pytest.mark.parametrize(("name", "make"), [("a.ply", ply), ("a.obj", obj), ("a.off", off)])
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_coordinates_that_are_not_finite_are_refused_with_the_first_and_how_many(tmp_path, name, make, value):
    wrong = V.copy()
    wrong[[1, 3], 2] = value
    assert "2 of 5 vertices are NaN or infinite, the first is vertex 1" in refusal(written(tmp_path, name, make(V=wrong)))


@pytest.mark.parametrize("form", ["ascii", "binary_little_endian"])
def test_header_that_claims_more_than_the_file_can_hold_is_refused_before_memory_is_taken(tmp_path, form):
    message = refusal(written(tmp_path, "a.ply", ply(form=form, claimed=10**12)))
    assert "its header claims 1000000000000 × vertex in" in message
    assert "claims 1000000000000 vertices" in refusal(written(tmp_path, "a.off", b"OFF\n1000000000000 4 0\n0 0 0\n"))


def test_binary_ply_of_mixed_polygons_is_refused_with_the_remedy(tmp_path):
    message = refusal(written(tmp_path, "a.ply", ply(F=[[0, 1, 2], [0, 1, 2, 3]])))
    assert "triangulate it when exporting, or save it as ASCII" in message


@pytest.mark.parametrize("uri", ["../../etc/passwd", "http://localhost:9/a.bin", "file:///etc/passwd"])
def test_glb_never_opens_what_lies_outside_it(tmp_path, uri):
    written(tmp_path, "a.bin", bytes(36))
    content = glb({"asset": {"version": "2.0"}, "buffers": [{"uri": uri, "byteLength": 36}]})
    message = refusal(written(tmp_path, "a.glb", content))
    assert f"keeps its data outside itself, in '{uri}', which is not opened" in message


def test_glb_of_arrays_without_bytes_is_refused_before_memory_is_taken(tmp_path):
    header = {
        "asset": {"version": "2.0"},
        "bufferViews": [],
        "accessors": [{"componentType": 5126, "count": 10**12, "type": "VEC3"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    }
    message = refusal(written(tmp_path, "a.glb", glb(header)))
    assert "uses sparse or compressed arrays, which is not read" in message
    header["extensionsRequired"] = ["KHR_draco_mesh_compression"]
    assert "uses KHR_draco_mesh_compression, which is not read" in refusal(written(tmp_path, "a.glb", glb(header)))


def test_glb_that_places_a_mesh_too_often_is_refused_before_memory_is_taken(tmp_path):
    n = 60_000
    body = np.zeros((1000, 3), dtype="<f4").tobytes()
    header = {
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": len(body)}],
        "bufferViews": [{"buffer": 0, "byteLength": len(body)}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 999, "type": "VEC3"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "nodes": [{"mesh": 0}] * n,
        "scenes": [{"nodes": list(range(n))}],
    }
    assert "its scene unfolds to 59940000 vertices" in refusal(written(tmp_path, "a.glb", glb(header, body)))


# ── all frames in one file ──────────────────────────────────────────────────────────────────────────────────────────


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
        ({"face_offsets": np.array([0, 4, 9])}, "vertex_offsets tell of 3 frames, face_offsets of 2; they must agree"),
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
