"""What the task reads from files, and that nothing it meets ends a run."""

from pathlib import Path

import numpy as np
import trimesh
from PIL import Image
from shapes import sphere
from textured import MTL, corner_uv, obj, png

from kinetree.pipeline.identity.key import digest, file_digest
from kinetree.schemas.input.mesh import MeshParams
from kinetree.schemas.input.source import Source
from kinetree.schemas.input.synth import SynthParams
from kinetree.schemas.registration.vertex_colour import VertexColour, VertexColourParams
from kinetree.tasks.input.mesh import mesh
from kinetree.tasks.input.synth import recipe
from kinetree.tasks.registration.vertex_colour import vertex_colour

V, F = sphere(2)
COLOURS = np.random.default_rng(0).integers(0, 256, (len(V), 3), dtype=np.uint8)


def read(path: Path, **params: str) -> VertexColour:
    """The colours of a frame that is one file."""
    source = Source(content=file_digest(path), path=str(path))
    return vertex_colour(source, mesh(source, MeshParams()), VertexColourParams.model_validate(params))


def ply(path: Path, colours: np.ndarray | None) -> Path:
    path.write_bytes(trimesh.Trimesh(V, F, vertex_colors=colours, process=False).export(file_type="ply"))
    return path


def test_colours_of_a_ply_are_those_of_its_vertices(tmp_path: Path) -> None:
    assert np.array_equal(read(ply(tmp_path / "a.ply", COLOURS)).colour, COLOURS)


def test_colours_are_not_read_where_that_is_not_wanted_and_there_are_none_without(tmp_path: Path) -> None:
    assert not len(read(ply(tmp_path / "a.ply", COLOURS), use="never").colour)
    assert not len(read(ply(tmp_path / "b.ply", None)).colour)


def test_texture_of_an_obj_is_seen_at_its_vertices(tmp_path: Path) -> None:
    (tmp_path / "a.obj").write_text(obj(V, F, corner_uv(V, F)))
    (tmp_path / "skin.mtl").write_text(MTL)
    Image.fromarray(np.array([[[200, 30, 60]], [[20, 30, 60]]], np.uint8)).save(tmp_path / "skin.png")
    found = read(tmp_path / "a.obj").colour
    assert found.shape == V.shape
    assert (found[:, 1:] == (30, 60)).all()
    assert {20, 200} <= set(found[:, 0].tolist())


def test_texture_that_is_damaged_or_not_there_is_no_colour(tmp_path: Path) -> None:
    (tmp_path / "a.obj").write_text(obj(V, F, corner_uv(V, F)))
    assert not len(read(tmp_path / "a.obj").colour)
    (tmp_path / "skin.mtl").write_text(MTL)
    (tmp_path / "skin.png").write_bytes(png()[:40])
    assert not len(read(tmp_path / "a.obj").colour)


def test_colours_that_are_no_numbers_are_none(tmp_path: Path) -> None:
    vertices = [f"v {x} {y} {z} nan 0 {z}" for x, y, z in V]
    faces = [f"f {a} {b} {c}" for a, b, c in F + 1]
    (tmp_path / "a.obj").write_text("\n".join([*vertices, *faces]))
    assert not len(read(tmp_path / "a.obj").colour)


def test_generated_body_has_its_paint_and_an_unpainted_one_nothing() -> None:
    for kind, expected in (("patterned", True), ("none", False)):
        written = recipe(SynthParams(frames=2, vertices=400, paint=kind))
        source = Source(content=digest(["synth", written, 1]), path="", part=1, recipe=written, kind="synth")
        surface = mesh(source, MeshParams())
        found = vertex_colour(source, surface, VertexColourParams()).colour
        assert (len(found) == len(surface.vertices)) is expected
