"""Colours and textures of GLBs, with motion and without, in the order in which their surfaces are read."""

import numpy as np
import pytest
import trimesh
from numerics.input.animated_glbs import F, GlbDraft
from PIL import Image
from shapes import sphere
from textured import png
from trimesh.visual.material import PBRMaterial
from trimesh.visual.texture import TextureVisuals

from kinetree.errors import MeshError, SourceError
from kinetree.tasks.numerics.input.animated_glb import AnimatedGlb
from kinetree.tasks.numerics.input.formats import mesh_of
from kinetree.tasks.numerics.input.gltf_appearance import glb_appearance
from kinetree.tasks.numerics.input.pictures import Picture
from kinetree.tasks.numerics.input.surface_appearance import surface_appearance


def textured(uv, name, rgb):
    V, faces = sphere(1)
    material = PBRMaterial(name=name, baseColorTexture=Image.new("RGB", (4, 4), rgb), baseColorFactor=(255, 255, 255, 255))
    return trimesh.Trimesh(V, faces, visual=TextureVisuals(uv=uv, material=material), process=False)


def test_scene_of_textured_meshes_one_of_them_mirrored_is_read_in_the_order_of_its_surface():
    rng = np.random.default_rng(0)
    V, _ = sphere(1)
    uv = rng.random((2, len(V), 2))
    scene = trimesh.Scene()
    scene.add_geometry(textured(uv[0], "red", (255, 0, 0)), node_name="a", geom_name="a")
    mirror = np.diag([-1.0, 1, 1, 1])
    mirror[0, 3] = 5.0
    scene.add_geometry(textured(uv[1], "blue", (0, 0, 255)), node_name="b", geom_name="b", transform=mirror)
    raw = scene.export(file_type="glb")
    X, G = mesh_of(raw, "scene", ".glb")
    look = glb_appearance(raw, G, moves=False)
    np.testing.assert_array_equal(look.faces, G)
    coordinates = np.concatenate([uv[int(X[block].mean() > 0.5)] for block in np.split(np.arange(len(X)), 2)])
    np.testing.assert_allclose(look.uv * (1, -1) + (0, 1), coordinates[G], atol=1e-6)
    first = [look.materials[k].name for k in (look.material[0], look.material[-1])]
    assert first == (["red", "blue"] if X[: len(V), 0].max() < 2 else ["blue", "red"])
    assert [look.pictures[look.materials[k].picture].media for k in (1, 2)] == ["image/png"] * 2


def test_moving_mesh_has_its_colours_material_and_picture():
    glb = GlbDraft().moves("translation", [0, 1, 2], [[0, 0, 0], [1, 0, 0], [2, 0, 0]])
    colour = np.float32([[1, 0, 0, 1], [0, 1, 0, 1], [0, 0, 1, 1], [1, 1, 1, 1]])
    glb.primitive["attributes"]["COLOR_0"] = glb.add(colour)
    glb.document["images"] = [{"bufferView": glb.view(png()), "mimeType": "image/png"}]
    glb.document["textures"] = [{"source": 0}]
    pbr = {"baseColorFactor": [0.5, 1, 1, 1], "baseColorTexture": {"index": 0}}
    glb.document["materials"] = [{"name": "skin", "pbrMetallicRoughness": pbr}]
    glb.primitive["material"] = 0
    _, G = AnimatedGlb(glb.raw(), "made").mesh(1)
    look = glb_appearance(glb.raw(), G, moves=True)
    np.testing.assert_array_equal(look.faces, G)
    np.testing.assert_allclose(look.colour, colour[G, :3])
    assert look.pictures == (Picture(png(), "image/png"),)
    assert look.materials[look.material[0]] == ("skin", (0.5, 1, 1, 1), 0)


def test_colours_of_a_glb_that_are_no_numbers_are_refused():
    glb = GlbDraft()
    glb.primitive["attributes"]["COLOR_0"] = glb.add(np.full((4, 4), np.inf, np.float32))
    with pytest.raises(MeshError, match="its colours are not all finite"):
        surface_appearance(glb.raw(), ".glb", F, {}.get)
    glb = GlbDraft()
    glb.document["materials"] = [{"pbrMetallicRoughness": {"baseColorFactor": [np.nan, 1, 1, 1]}}]
    with pytest.raises(MeshError, match="its colours are not all finite"):
        surface_appearance(glb.raw(), ".glb", F, {}.get)


def test_picture_outside_the_file_is_not_opened_and_said():
    glb = GlbDraft()
    glb.document |= {"images": [{"uri": "../skin.png", "name": "skin"}], "textures": [{"source": 0}]}
    glb.document["materials"] = [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]
    glb.primitive["material"] = 0
    look = glb_appearance(glb.raw(), F, moves=False)
    assert look.missing == ("picture skin: lies outside the file",)
    assert look.materials[1].picture is None


def test_mesh_without_appearance_has_none_and_another_mesh_is_refused():
    assert glb_appearance(GlbDraft().raw(), F, moves=False) is None
    with pytest.raises(SourceError, match="shows other faces"):
        glb_appearance(GlbDraft().raw(), F[1:], moves=False)
