"""Laws of binary PLY read without trimesh: the same numbers as trimesh reads, and none of a file that is another."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from shapes import sphere
from trimesh import Trimesh
from trimesh.exchange.ply import export_ply, load_ply
from trimesh.util import wrap_as_stream

from kinetree.tasks.numerics.input.formats import mesh_of
from kinetree.tasks.numerics.input.ply_triangles import binary_triangles

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


def test_reading_it_imports_no_trimesh(tmp_path: Path) -> None:
    (tmp_path / "mesh.ply").write_bytes(written())
    ask = "import sys; from kinetree.tasks.numerics.input.formats import read_mesh\n"
    ask += "read_mesh(sys.argv[1]); assert 'trimesh' not in sys.modules"
    subprocess.run([sys.executable, "-P", "-c", ask, str(tmp_path / "mesh.ply")], check=True)
