"""From a textured file to skeleton.glb: what is kept, what is refused, and what Blender and the validator make of it."""

import json
import zipfile
from pathlib import Path

import numpy as np
import pytest
from results.blender_reader import opened
from results.gltf_reader import Glb as Read
from results.gltf_validator import issues
from results.plain_names import plain
from results.rigged_bodies import skinned, spider
from textured import MTL, corner_uv, obj, png

from kinetree.pipeline import views
from kinetree.pipeline.identity.key import file_digest
from kinetree.schemas.input.mesh import MeshParams
from kinetree.schemas.input.source import Source
from kinetree.schemas.results.appearance import Appearance
from kinetree.schemas.results.glb import GlbParams
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.input.frames.read import mesh_digest, packed_frames
from kinetree.tasks.input.mesh import mesh
from kinetree.tasks.results.appearance import appearance
from kinetree.tasks.results.formats.colours import linear, srgb
from kinetree.tasks.results.glb import glb
from kinetree.tasks.results.page.surface_colours import surface_colours

UP = UpDirection(up="y", confidence=1.0)
FILES = {"frame.obj": None, "skin.mtl": MTL.encode(), "skin.png": png()}


def write(folder, **changes):
    """A textured OBJ of the spider in a folder, with the files that it names; `changes` replace the text of files by stem."""
    folder.mkdir(parents=True, exist_ok=True)
    body = spider()
    text = obj(body.vertices, body.faces, corner_uv(body.vertices, body.faces))
    for name, raw in FILES.items():
        data = changes.get(name.partition(".")[0] if raw is not None else "obj", text.encode() if raw is None else raw)
        if data is not None:
            (folder / name).write_bytes(data)
    return Source(content=file_digest(folder / "frame.obj"), path=str(folder / "frame.obj"))


def look_and_body(source):
    """The appearance of a frame, and the skeleton whose reference mesh it is."""
    surface = mesh(source, MeshParams())
    body = spider(vertices=surface.vertices, faces=surface.faces)
    return appearance(body, {3: source}, {3: surface}), body


def exported(look, body, **params):
    files = views.files(glb(body, plain(body), UP, GlbParams(scale=1.0, **params), look), ())
    return files["skeleton.glb"]


def test_textured_obj_with_seams_is_welded_for_the_skeleton_and_textured_in_the_file(tmp_path):
    look, body = look_and_body(write(tmp_path))
    assert (look.frame, look.missing) == (3, ())
    assert len(body.vertices) == len(spider().vertices)  # the copies at seams are welded
    file = Read(exported(look, body))
    uv = corner_uv(body.vertices, body.faces) * (1, -1) + (0, 1)
    np.testing.assert_allclose(file.attribute("TEXCOORD_0")[file.faces], uv, atol=1e-6)
    np.testing.assert_allclose(file.attribute("POSITION")[file.faces], body.vertices[body.faces], rtol=1e-6)
    size = np.linalg.norm(np.ptp(body.vertices, axis=0))
    for t in (0, 5, 11):
        assert np.abs(file.skinned(t)[file.faces] - skinned(body)[t][body.faces]).max() < 2e-6 * size
    (image,) = file.json["images"]
    view = file.json["bufferViews"][image["bufferView"]]
    assert file.buffer[view["byteOffset"] :][: view["byteLength"]] == png()
    (primitive,) = file.json["meshes"][0]["primitives"]
    assert "COLOR_0" not in primitive["attributes"]  # which would darken the texture
    material = file.json["materials"][primitive["material"]]["pbrMetallicRoughness"]
    assert file.json["textures"][material["baseColorTexture"]["index"]]["source"] == 0


def test_parts_are_coloured_where_they_are_asked_for_or_there_is_nothing_else(tmp_path):
    look, body = look_and_body(write(tmp_path))
    assert exported(look, body, surface="parts") == exported(Appearance.none(), body)
    assert "images" not in Read(exported(Appearance.none(), body)).json


def test_zip_of_textured_frames_has_its_texture(tmp_path):
    write(tmp_path / "walk")
    with zipfile.ZipFile(tmp_path / "walk.zip", "w") as archive:
        for name in FILES:
            archive.write(tmp_path / "walk" / name, f"walk/{name}")
    digest = mesh_digest(*packed_frames(tmp_path / "walk.zip", "animated").mesh(0))
    look, _ = look_and_body(Source(content=digest, path=str(tmp_path / "walk.zip"), part=0, kind="animated"))
    assert look.content.tobytes() == png()
    assert look.has_uv


@pytest.mark.parametrize("named", ["../secret.png", "/etc/hostname", "..\\secret.png"])
def test_no_file_outside_the_folder_is_opened(tmp_path, named):
    (tmp_path / "secret.png").write_bytes(png((1, 2, 3)))
    look, body = look_and_body(write(tmp_path / "walk", skin=f"newmtl skin\nmap_Kd {named}\n".encode()))
    assert look.media == ()
    assert [text.endswith(f"{named} is not there") for text in look.missing] == [True]
    exported_glb = glb(body, plain(body), UP, GlbParams(scale=1.0), look)
    assert views.remarks(exported_glb) == look.missing


def test_link_out_of_the_folder_is_not_followed(tmp_path):
    source = write(tmp_path / "walk")
    (tmp_path / "walk" / "skin.png").unlink()
    (tmp_path / "secret.png").write_bytes(png())
    (tmp_path / "walk" / "skin.png").symlink_to(tmp_path / "secret.png")
    assert look_and_body(source)[0].media == ()


def test_damaged_picture_is_said_and_the_rest_is_kept(tmp_path):
    source = write(tmp_path)
    (tmp_path / "skin.png").write_bytes(png()[:30])
    look, body = look_and_body(source)
    assert "skin.png: cannot be read as a picture" in look.missing[0]
    assert "TEXCOORD_0" in Read(exported(look, body)).json["meshes"][0]["primitives"][0]["attributes"]


def test_colours_and_coordinates_that_are_no_numbers_are_said_and_fail_nothing(tmp_path):
    look, _ = look_and_body(write(tmp_path / "a", skin=b"newmtl skin\nKd nan 0 0\n"))
    assert look.missing == ("frame.obj: no texture and colours: its colours are not all finite; export it again",)
    text = (tmp_path / "a" / "frame.obj").read_bytes()
    place = text.index(b"\nvt ")
    look, _ = look_and_body(write(tmp_path / "b", obj=text[:place] + b"\nvt nan nan" + text[text.index(b"\n", place + 1) :]))
    assert not len(look.vertex)
    assert look.missing == ("frame.obj: no texture and colours: uv: 2 values are not finite, the first at (5, 0)",)


def test_reference_that_is_no_frame_has_no_appearance(tmp_path):
    source = write(tmp_path)
    surface = mesh(source, MeshParams())
    assert appearance(spider(vertices=spider().vertices + 1.0), {3: source}, {3: surface}).frame is None


def test_frames_in_a_bucket_have_none_and_nothing_is_said_to_be_wrong(tmp_path):
    surface = mesh(write(tmp_path), MeshParams())
    body = spider(vertices=surface.vertices, faces=surface.faces)
    look = appearance(body, {3: Source(content="", path="s3://bucket/frame.obj")}, {3: surface})
    assert (look.frame, look.missing) == (None, ())


def test_validator_finds_nothing_to_say(tmp_path):
    look, body = look_and_body(write(tmp_path))
    (tmp_path / "skeleton.glb").write_bytes(exported(look, body))
    told = issues(tmp_path / "skeleton.glb")
    assert told["messages"] == [], json.dumps(told)[:2000]


def test_blender_has_the_texture_and_its_coordinates(tmp_path: Path):
    look, body = look_and_body(write(tmp_path))
    (tmp_path / "skeleton.glb").write_bytes(exported(look, body))
    imported = opened(tmp_path / "skeleton.glb", 10.0, [0])
    (image,) = imported["images"]
    assert image[1] == [4, 4]
    assert imported["materials"] == [[image[0]]]
    place = np.array(imported["skin"][0])[imported["corners"]].reshape(-1, 3, 3) @ [[1, 0, 0], [0, 0, -1], [0, 1, 0]]
    truth = skinned(body)[0][body.faces]
    np.testing.assert_allclose(place, truth, atol=1e-4 * np.ptp(truth))
    uv = np.array(imported["uv"][0]).reshape(-1, 3, 2)
    np.testing.assert_allclose(uv, corner_uv(body.vertices, body.faces), atol=1e-5)


def test_page_has_the_colour_of_the_texture_at_every_vertex(tmp_path: Path):
    look, body = look_and_body(write(tmp_path))
    colours = surface_colours(look, len(body.vertices))
    assert colours is not None
    assert colours.shape == (len(body.vertices), 3)
    tinted = srgb(linear(np.array([200, 30, 30], np.uint8)) * np.array(look.materials[0].colour[:3]))
    assert np.abs(colours.astype(int) - tinted).max() <= 1
    assert surface_colours(Appearance.none(), 5) is None
