"""What Blender makes of skeleton.glb, of the FBX that its script writes, of skeleton.usda and of skeleton.bvh."""

import ast
import importlib.util

import numpy as np
import pytest
from results.blender_reader import command, opened, run
from results.plain_names import plain
from results.rigged_bodies import skinned, spider

from kinetree.pipeline import views
from kinetree.schemas.results.bvh import BvhParams
from kinetree.schemas.results.glb import GlbParams
from kinetree.schemas.results.usd import UsdParams
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.results.blender import blender
from kinetree.tasks.results.bvh import bvh
from kinetree.tasks.results.glb import glb
from kinetree.tasks.results.usd import usd

FRAMES = [0, 5, 11]
Z_UP = UpDirection(up="z", confidence=0.9)


@pytest.fixture(scope="module")
def body():
    return spider()


@pytest.fixture(scope="module")
def folder(body, tmp_path_factory):
    """The files of the export, and what Blender made of them."""
    folder = tmp_path_factory.mktemp("blender")
    for name, data in files(body).items():
        (folder / name.removeprefix("blender/")).write_bytes(data)
    return folder


def files(skeleton):
    return views.files(blender(glb(skeleton, plain(skeleton), Z_UP, GlbParams()), skeleton), ())


def test_script_lies_beside_the_file_that_it_reads_and_knows_the_pace(body):
    written = files(body)
    assert list(written) == ["blender/skeleton.glb", "blender/to_fbx.py"]
    assert written["blender/skeleton.glb"] == views.files(glb(body, plain(body), Z_UP, GlbParams()), ())["skeleton.glb"]
    ast.parse(written["blender/to_fbx.py"])
    assert b"FPS = 10.0\n" in written["blender/to_fbx.py"]
    assert b"FPS = 30.0\n" in files(spider(fps=None))["blender/to_fbx.py"]


@pytest.mark.parametrize("name", ["skeleton.glb", "skeleton.fbx", "skeleton.usda"])
def test_blender_has_joints_bones_and_skin_where_they_are_in_metres_and_upright(body, folder, name):
    command()
    if name == "skeleton.fbx":
        run(folder / "to_fbx.py")
    if name == "skeleton.usda":
        if importlib.util.find_spec("pxr") is None:
            pytest.skip("pip install 'kinetree[usd]' brings Pixar's library")
        written = views.files(usd(body, plain(body), Z_UP, UsdParams()), ())[name]
        (folder / name).write_bytes(written)
    imported = opened(folder / name, 10.0, FRAMES)
    np.testing.assert_allclose(list(imported["matrices"].values()), np.tile(np.eye(4), (2, 1, 1)), atol=1e-5)
    truth = skinned(body) / 1000
    size = np.ptp(truth[0], axis=0).max()
    for t, heads, skin in zip(FRAMES, imported["heads"], imported["skin"], strict=True):
        expected = body.positions[t] / 1000
        np.testing.assert_allclose([heads[n] for n in body.names], expected, atol=2e-4 * size)
        np.testing.assert_allclose(skin, truth[t], atol=2e-4 * size)
    assert imported["frames"] == [0.0, 11.0]
    arm = np.linalg.norm(np.subtract(imported["rest"]["hand"], imported["rest"]["arm"]))
    assert arm == pytest.approx(body.lengths[body.names.index("hand")] / 1000, rel=1e-4)
    if name == "skeleton.glb":  # FBX knows joints and no bones
        assert imported["lengths"]["arm"] == pytest.approx(arm, rel=1e-4)


def test_blender_has_the_joints_of_the_bvh_where_they_are_in_metres_and_upright(body, tmp_path):
    (tmp_path / "skeleton.bvh").write_bytes(views.files(bvh(body, plain(body), Z_UP, BvhParams()), ())["skeleton.bvh"])
    imported = opened(tmp_path / "skeleton.bvh", 10.0, [t + 1 for t in FRAMES])  # Blender begins with frame 1
    np.testing.assert_allclose(imported["matrices"]["skeleton"], np.eye(4), atol=1e-5)
    assert imported["frames"] == [1.0, 12.0]
    assert {"trunk", "arm", "knee"} <= set(imported["rest"])
    for t, heads in zip(FRAMES, imported["heads"], strict=True):
        expected = {name: body.positions[t, j] / 1000 for j, name in enumerate(body.names)}
        size = np.ptp(body.vertices, axis=0).max() / 1000
        np.testing.assert_allclose(list(heads.values()), [expected[name] for name in heads], atol=2e-4 * size)
