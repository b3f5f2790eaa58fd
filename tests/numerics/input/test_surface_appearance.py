"""What a file says its surface looks like, by the corners of the faces that geometry is read with."""

import tracemalloc

import numpy as np
import pytest
import trimesh
from shapes import sphere
from textured import MTL, corner_uv, obj, png

from kinetree.errors import MeshError
from kinetree.tasks.numerics.input import surface_appearance as module
from kinetree.tasks.numerics.input.formats import mesh_of
from kinetree.tasks.numerics.input.surface_appearance import surface_appearance

FILES = {"skin.mtl": MTL.encode(), "skin.png": png()}
QUADS = b"""mtllib two.mtl
v 0 0 0 1 0 0
v 1 0 0 1 0 0
v 1 1 0 1 0 0
v 0 1 0 0.5 0.5 0.5
v 0.5 2 0 1 1 1
vt 0 0
vt 1 0
vt 1 1
vt 0 1
usemtl first
f 1/1 2/2 3/3 4/4
usemtl second
f -2/4 -3/-2 -1
"""
TWO = b"newmtl first\nKd 0.25 0.5 0.75\nnewmtl second\nmap_Kd gone.png\n"


def read(raw, suffix, files=FILES):
    return surface_appearance(raw, suffix, mesh_of(raw, "frame", suffix)[1], files.get)


@pytest.mark.parametrize("copies", [False, True])
def test_obj_has_the_coordinates_of_every_corner_from_the_upper_left(copies):
    V, F = sphere(2)
    uv = corner_uv(V, F)
    look = read(obj(V, F, uv, copies=copies).encode(), ".obj")
    np.testing.assert_allclose(look.uv, uv * (1, -1) + (0, 1), atol=1e-12)
    assert [m.picture for m in look.materials] == [None, 0]
    assert (look.material == 1).all()
    assert look.pictures[0].raw == png()
    assert look.materials[1].colour == (1, 1, 1, 1)  # not darkened under its picture


def test_obj_with_polygons_materials_colours_and_counts_from_the_end():
    look = read(QUADS, ".obj", {"two.mtl": TWO})
    _, F = mesh_of(QUADS, "frame", ".obj")
    expected = {0: (0, 1), 1: (1, 1), 2: (1, 0), 3: (0, 0)}
    for corner, uv, material in zip(F.ravel(), look.uv.reshape(-1, 2), np.repeat(look.material, 3), strict=True):
        if material == 1:
            np.testing.assert_allclose(uv, expected[corner])
    assert sorted(look.material) == [1, 1, 2]
    assert [m.colour for m in look.materials] == [(1, 1, 1, 1), (0.25, 0.5, 0.75, 1), (1, 1, 1, 1)]
    assert look.missing == ("gone.png is not there",)
    np.testing.assert_allclose(look.colour[F == 3], [[0.21404114] * 3] * (F == 3).sum(), atol=1e-7)  # sRGB 0.5


def test_obj_without_any_has_none():
    V, F = sphere(1)
    plain = "".join(f"v {x} {y} {z}\n" for x, y, z in V) + "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in F)
    assert read(plain.encode(), ".obj") is None


@pytest.mark.parametrize("encoding", ["ascii", "binary"])
def test_ply_has_the_colours_of_vertices_in_linear_light(encoding):
    V, F = sphere(1)
    rgb = np.random.default_rng(0).integers(0, 256, (len(V), 3)).astype(np.uint8)
    raw = trimesh.Trimesh(V, F, vertex_colors=rgb, process=False).export(file_type="ply", encoding=encoding)
    look = read(raw, ".ply")
    c = rgb / 255
    linear = np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
    np.testing.assert_allclose(look.colour, linear[F], atol=1e-12)
    assert look.uv is None


@pytest.mark.parametrize("way", ["corners", "vertices"])
def test_ply_has_coordinates_of_corners_or_of_vertices_and_the_texture_that_it_names(way):
    V, F = sphere(1)
    uv = corner_uv(V, F)
    per_vertex = np.zeros((len(V), 2))
    per_vertex[F] = uv
    at = uv if way == "corners" else per_vertex[F]
    head = ["ply", "format ascii 1.0", "comment TextureFile skin.png", f"element vertex {len(V)}"]
    head += [f"property double {k}" for k in ("xyz" if way == "corners" else "xyzst")] + [f"element face {len(F)}"]
    head += ["property list uchar int vertex_indices"] + (["property list uchar double texcoord"] if way == "corners" else [])
    rows = V if way == "corners" else np.column_stack([V, per_vertex])
    text = [" ".join(map(repr, map(float, row))) for row in rows]
    for face, own in zip(F, uv, strict=True):
        text.append("3 " + " ".join(map(str, face)) + (" 6 " + " ".join(map(str, own.ravel())) if way == "corners" else ""))
    look = read("\n".join([*head, "end_header", *text, ""]).encode(), ".ply")
    np.testing.assert_allclose(look.uv, at * (1, -1) + (0, 1), atol=1e-6)
    assert look.pictures[0].raw == png()


def test_draco_has_the_colours_of_vertices():
    draco = pytest.importorskip("DracoPy")
    V, F = sphere(1)
    rgb = np.full((len(V), 3), 255, np.uint8)
    rgb[V[:, 0] > 0] = (255, 0, 0)
    raw = draco.encode(V, F, colors=rgb)
    look = read(raw, ".drc")
    V, F = mesh_of(raw, "frame", ".drc")
    expected = np.where(V[:, :1] > 1e-3, (1.0, 0.0, 0.0), (1.0, 1.0, 1.0))
    clear = np.abs(V[:, 0]) > 1e-2
    np.testing.assert_allclose(look.colour[clear[F]], expected[F][clear[F]])


def test_faces_that_are_not_those_of_the_surface_are_refused():
    V, F = sphere(1)
    raw = obj(V, F, corner_uv(V, F)).encode()
    with pytest.raises(MeshError, match="of other faces than its surface"):
        surface_appearance(raw, ".obj", F[:-1], FILES.get)


@pytest.mark.parametrize(
    ("old", "new"), [(b"1 1 0 1 0 0", b"1 1 0 1 nan 0"), (b"two.mtl", b"nan.mtl")], ids=["of a vertex", "of a material"]
)
def test_colours_that_are_no_numbers_are_refused(old, new):
    assert old in QUADS
    with pytest.raises(MeshError, match=r"^its colours are not all finite; export it again$"):
        read(QUADS.replace(old, new), ".obj", {"two.mtl": TWO, "nan.mtl": b"newmtl first\nKd nan inf -1\n"})


def test_appearance_of_an_obj_takes_little_more_memory_than_its_arrays():
    raw = b"v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nvt 0 0\n" + b"f 1/1 2/1 3/1\n" * 10**5
    F = mesh_of(raw, "frame", ".obj")[1]
    tracemalloc.start()
    look = surface_appearance(raw, ".obj", F, FILES.get)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    kept = look.faces.nbytes + look.uv.nbytes + look.colour.nbytes + look.material.nbytes
    assert len(look.faces) == 10**5
    assert peak < 2 * kept


def test_colours_of_a_long_text_of_ply_are_refused(monkeypatch):
    V, F = sphere(1)
    rgb = np.zeros((len(V), 3), np.uint8)
    raw = trimesh.Trimesh(V, F, vertex_colors=rgb, process=False).export(file_type="ply", encoding="ascii")
    assert read(raw, ".ply") is not None
    monkeypatch.setattr(module, "_MOST_TEXT_BYTES", len(raw) - 1)
    with pytest.raises(MeshError, match=rf"^{len(raw)} bytes of text, more than {len(raw) - 1}; save it as binary$"):
        read(raw, ".ply")


def test_formats_without_appearance_have_none():
    assert surface_appearance(b"", ".stl", np.zeros((1, 3), np.int32), FILES.get) is None


def test_more_materials_than_a_capture_has_are_refused():
    V, F = sphere(1)
    text = obj(V, F, corner_uv(V, F)) + "".join(f"usemtl m{n}\n" for n in range(module.MOST_MATERIALS))
    with pytest.raises(MeshError, match="more than 1024 materials"):
        read(text.encode(), ".obj")


def test_pictures_that_are_too_large_together_are_left_out(monkeypatch):
    monkeypatch.setattr(module, "MOST_PICTURE_BYTES", len(png()))
    library = b"newmtl first\nmap_Kd skin.png\nnewmtl second\nmap_Kd -bm 1 other.png\n"
    look = read(QUADS, ".obj", {"two.mtl": library, "skin.png": png(), "other.png": png()})
    assert [m.picture for m in look.materials] == [None, 0, None]
    assert look.missing == (f"other.png: with it all pictures have more than {len(png())} bytes",)
