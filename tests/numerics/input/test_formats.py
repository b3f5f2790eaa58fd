"""Laws of reading one file: vertices exactly as in it, and the words of every refusal."""

import json
import os
import struct
import tracemalloc

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from kinetree.errors import MeshError
from kinetree.tasks.numerics.input import unpacked
from kinetree.tasks.numerics.input.formats import checked, read_mesh

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
    assert ".fbx is not read; .ply .obj .off .stl .glb .drc are" in refusal(tmp_path / "a.fbx")
    (tmp_path / "a.ply").mkdir()
    assert "not a file" in refusal(tmp_path / "a.ply")


def test_pipe_is_refused_instead_of_waited_for(tmp_path):
    os.mkfifo(tmp_path / "a.ply")
    assert "not a file" in refusal(tmp_path / "a.ply")


@pytest.mark.parametrize(("name", "make"), [("a.ply", ply), ("a.obj", obj), ("a.off", off)])
def test_point_cloud_is_refused(tmp_path, name, make):
    assert "no faces, only 5 vertices; a surface is needed, not a point cloud: mesh the points first" in refusal(
        written(tmp_path, name, make(F=[]))
    )


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


def test_mesh_is_checked_in_no_more_memory_than_it_takes():
    X, G = np.eye(3), np.tile(np.arange(3, dtype=np.int32), (10**5, 1))
    tracemalloc.start()
    checked(X, G, "a")
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 1.1 * G.nbytes


def test_glb_that_places_a_mesh_too_often_is_refused_before_memory_is_taken(tmp_path, monkeypatch):
    monkeypatch.setattr(unpacked, "UNPACKED_BYTES", 2**32)
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
    message = refusal(written(tmp_path, "a.glb", glb(header, body)))
    assert "its scene unfolds to 59940000 vertices and 19980000 faces, more than 50000000 and 100000000" in message


# ── what is wrong and would pass in silence ─────────────────────────────────────────────────────────────────────────


def rows(text, old, new):
    assert old in text
    return text.replace(old, new, 1)


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("a.ply", ply(form="ascii").replace(b"face 4", b"face 3"), "1 more line after the 8 that its header claims"),
        ("a.ply", ply(form="ascii").replace(b"vertex 5", b"vertex 4"), "1 more line after the 8 that its header claims"),
        ("a.ply", ply().replace(b"face 4", b"face 3"), "PLY is unexpected length"),
        ("a.off", off().replace(b"5 4 0", b"5 3 0"), "1 more line after the 8 that it claims"),
        ("a.off", rows(off(), b"3 0 2 1", b"1000000000 0 2 1"), "face 0 claims 1000000000 corners and has 3"),
        ("a.off", rows(off(), b"3 0 2 1", b"4 0 2 1"), "face 0 claims 4 corners and has 3"),
        ("a.off", rows(off(), b"3 0 1 3", b"2 0 1"), "face 1 has 2 corners"),
        ("a.off", rows(off(), b"3 0 1 3", b"-1 0 1"), "face 1 claims -1 corners"),
        ("a.obj", obj() + b"f 1 2\n", "face 4 has 2 corners"),
        ("a.obj", obj() + b"f \n", "face 4 has 0 corners"),
        ("a.ply", rows(ply(form="ascii"), b"3 0 2 1", b"4 0 2 1"), "face 0 is '4 0 2 1', which is not what its header says"),
        ("a.ply", rows(ply(form="ascii"), b"3 0 2 1", b"3 0 2 1 4"), "face 0 is '3 0 2 1 4'"),
        ("a.ply", rows(ply(form="ascii"), b"3 0 2 1", b"3 0 2 0.5"), "face 0 is '3 0 2 0.5'"),
        ("a.ply", rows(ply(form="ascii"), b"3 0 2 1", b"-1 0 2 1"), "face 0 is '-1 0 2 1'"),
        ("a.ply", rows(ply(form="ascii"), b"1.0 0.0 0.0", b"1.0 0.0 0.0 9"), "vertex 1 is '1.0 0.0 0.0 9'"),
        ("a.ply", rows(ply(form="ascii"), b"1.0 0.0 0.0", b"1.0 x 0.0"), "vertex 1 is '1.0 x 0.0'"),
        ("a.ply", ply(F=[[0, 1], [0, 2]], form="ascii"), "face 0 is '2 0 1'"),
        ("a.ply", rows(ply(), b"list uchar int", b"list uchar float"), "its faces are numbers of type float32"),
        ("a.ply", ply()[:-13] + b"\2" + ply()[-12:], "face 3 has 2 corners where the first has 3"),
    ],
)
def test_what_a_file_claims_and_what_it_holds_must_agree(tmp_path, name, content, words):
    message = refusal(written(tmp_path, name, content))
    assert words in message
    assert any(remedy in message for remedy in ("export it again", "the file is damaged", "triangulate it"))


@pytest.mark.parametrize(("form", "name"), [("ascii", "a.ply"), ("off", "a.off")])
def test_blank_lines_and_comments_are_no_rows(tmp_path, form, name):
    content = ply(form="ascii") + b"\n \n" if form == "ascii" else off().replace(b"OFF\n", b"OFF\n# by hand\n\n") + b"\n\n"
    assert len(read_mesh(written(tmp_path, name, content))[1]) == len(F)


@pytest.mark.parametrize(
    ("shift", "form", "fits"),
    [(1e15, "d", False), (1e12, "d", True), (1e5, "f", False), (3e3, "f", True), (-1e15, "d", False)],
)
def test_body_too_far_from_the_origin_for_its_digits_is_refused_with_the_remedy(tmp_path, shift, form, fits):
    X = V + [0, shift, 0]
    content = ply(X if form == "d" else X.astype(np.float32).astype(float))
    path = written(tmp_path, "a.ply", content)
    if fits:
        np.testing.assert_allclose(read_mesh(path)[0], X, atol=3e-4)
    else:
        message = refusal(path)
        assert "move the body to the origin before it is saved" in message
        assert "its coordinates reach" in message


# ── all frames in one file ──────────────────────────────────────────────────────────────────────────────────────────


def test_draco_is_read(tmp_path):
    draco = pytest.importorskip("DracoPy", reason="pip install 'kinetree[draco]' brings it")
    path = written(tmp_path, "f.drc", draco.encode(V, F, quantization_bits=16, preserve_order=True))
    X, G = read_mesh(path)
    np.testing.assert_allclose(X, V, atol=1e-3)
    assert sorted(map(sorted, G.tolist())) == sorted(map(sorted, F.tolist()))
    assert "cannot be read as DRC" in refusal(written(tmp_path, "g.drc", b"DRACO" + b"\xff" * 40))
