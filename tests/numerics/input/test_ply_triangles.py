"""Laws of PLY read without trimesh: the same numbers as trimesh reads, and none of a file that is another."""

import subprocess
import sys
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from shapes import sphere
from trimesh import Trimesh
from trimesh.exchange.ply import export_ply, load_ply
from trimesh.util import wrap_as_stream

from kinetree.errors import MeshError
from kinetree.tasks.numerics.input import formats
from kinetree.tasks.numerics.input.formats import mesh_of
from kinetree.tasks.numerics.input.ply_triangles import binary_triangles, text_polygons

V, F = sphere(2)


def written(**options: object) -> bytes:
    mesh = Trimesh(V + 0.1, F, process=False, vertex_colors=np.arange(4 * len(V), dtype=np.uint8).reshape(-1, 4))
    return bytes(export_ply(mesh, **options))


def parts(raw: bytes) -> tuple[bytes, bytes]:
    header, _, body = raw.partition(b"end_header")
    return header, body


@pytest.mark.parametrize("normals", [False, True])
def test_vertices_and_faces_are_those_that_trimesh_reads(normals: bool) -> None:
    raw = written(vertex_normal=normals)
    read = load_ply(wrap_as_stream(raw))
    triangles = binary_triangles(*parts(raw))
    assert triangles is not None
    np.testing.assert_array_equal(triangles[0], np.asarray(read["vertices"], np.float64))
    np.testing.assert_array_equal(triangles[1], read["faces"])
    vertices, faces = mesh_of(raw, "file", ".ply")
    np.testing.assert_array_equal(vertices, triangles[0])
    np.testing.assert_array_equal(faces, F)


def test_every_other_file_is_left_to_trimesh() -> None:
    header, body = parts(written())
    first = body.index(b"\3", 1 + len(V) * ((len(body) - 1 - 13 * len(F)) // len(V)))
    others = [
        (header, body[:-1]),
        (header, body + b"\0"),
        (header, body[:first] + b"\4" + body[first + 1 :]),
        (header.replace(b"binary_little_endian", b"binary_big_endian"), body),
        (header.replace(b"list uchar int", b"list uchar float"), body),
        (header.replace(b"property float z", b"property float y"), body),
        (header + b"element edge 0\n", body),
    ]
    assert all(header != parts(written())[0] or body != parts(written())[1] for header, body in others)
    assert [binary_triangles(*other) for other in others] == [None] * len(others)


def text(vertex: str = "double", more: bytes = b"", extra: str = "") -> tuple[bytes, bytes]:
    """A text of polygons of three to six corners, with a colour after each."""
    head = f"ply\nformat ascii 1.0\ncomment of a test\nelement vertex {len(V)}\n"
    head += "".join(f"property {vertex} {axis}\n" for axis in ("x", "nx", "y", "z"))
    head += f"element face 4\nproperty list uchar int vertex_indices\nproperty uchar red\n{extra}"
    rows = [" ".join(map(repr, map(float, (x + 0.1, 9, y, z)))) for x, y, z in V]
    rows += ["4 0 1 2 3 255", "3 4 5 6 255", "6 1 2 3 4 5 6 0", "4 3 2 1 0 1"]
    return head.encode(), "\n".join(["", *rows, ""]).encode() + more


@pytest.mark.parametrize("vertex", ["float", "double"])
@pytest.mark.parametrize("end", [b"\n", b"\r\n"])
def test_polygons_of_a_text_are_those_that_trimesh_reads(vertex: str, end: bytes) -> None:
    header, body = text(vertex)
    raw = (header + b"end_header" + body).replace(b"\n", end)
    read = load_ply(wrap_as_stream(raw))
    X, G = mesh_of(raw, "file", ".ply")
    np.testing.assert_array_equal(X, np.asarray(read["vertices"], np.float64))
    np.testing.assert_array_equal(G, read["faces"])
    found = text_polygons(*(part.replace(b"\n", end) for part in (header, body)))
    assert found is not None
    np.testing.assert_array_equal(found[0], X)
    np.testing.assert_array_equal(found[1], G)


def test_rows_of_other_elements_after_the_faces_are_passed_over() -> None:
    found = text_polygons(*text(more=b"0 1\n", extra="element edge 1\nproperty int vertex1\nproperty int vertex2\n"))
    expected = text_polygons(*text())
    assert found is not None
    assert expected is not None
    np.testing.assert_array_equal(found[1], expected[1])


def test_every_other_text_is_left_to_trimesh() -> None:
    header, body = text()
    changes = [
        (b"ascii", b"binary_little_endian"),
        (b"list uchar int vertex_indices", b"list uchar float vertex_indices"),
        (b"vertex_indices", b"texcoord"),
        (b"double x", b"int x"),
        (b"double z", b"double y"),
        (b"element face 4", b"element edge 0\nproperty int vertex1\nelement face 4"),
        (b"element face 4", b"element face 0"),
    ]
    assert all(old in header for old, _ in changes)
    assert [text_polygons(header.replace(*change), body) for change in changes] == [None] * len(changes)


def test_text_takes_little_more_memory_than_its_mesh() -> None:
    header = b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    header += b"element face 100000\nproperty list uchar int vertex_indices\n"
    body = b"\n0 0 0\n1 0 0\n0 1 0\n" + b"3 0 1 2\n" * 10**5
    tracemalloc.start()
    G = mesh_of(header + b"end_header" + body, "file", ".ply")[1]
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert len(G) == 10**5
    assert peak < 20 * len(body)


def test_long_text_of_an_unusual_layout_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    header, body = text()
    raw = header.replace(b"double x", b"int x") + b"end_header" + body
    assert len(mesh_of(raw, "file", ".ply")[1]) == 9
    monkeypatch.setattr(formats, "_MOST_UNUSUAL_BYTES", 1000)
    with pytest.raises(MeshError, match=r"^file: \d+ bytes of text in an unusual layout, more than 1000; save it as binary$"):
        mesh_of(raw, "file", ".ply")


def test_reading_it_imports_no_trimesh(tmp_path: Path) -> None:
    (tmp_path / "mesh.ply").write_bytes(written())
    ask = "import sys; from kinetree.tasks.numerics.input.formats import read_mesh\n"
    ask += "read_mesh(sys.argv[1]); assert 'trimesh' not in sys.modules"
    subprocess.run([sys.executable, "-P", "-c", ask, str(tmp_path / "mesh.ply")], check=True)
