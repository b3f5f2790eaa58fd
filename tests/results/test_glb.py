"""skeleton.glb, read back by a reader of its own, by the Khronos validator and by Blender where they are installed."""

import importlib.util
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from results.gltf_reader import Glb as Read
from results.rigged_bodies import skinned, spider

from kinetree.pipeline import views
from kinetree.schemas.results.glb import GlbParams
from kinetree.tasks.results.glb import glb

ROOT = Path(__file__).resolve().parents[2]
VALIDATE = """
const validator = require("gltf-validator");
validator.validateBytes(new Uint8Array(require("fs").readFileSync(process.argv[2])), {maxIssues: 20})
  .then((told) => console.log(JSON.stringify(told.issues)));
"""
BLENDER = """
import json, sys
import bpy
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.context.scene.render.fps = int(sys.argv[2])
bpy.ops.import_scene.gltf(filepath=sys.argv[1])
body = next(o for o in bpy.data.objects if o.type == "ARMATURE")
found = []
for frame in range(int(sys.argv[3])):
    bpy.context.scene.frame_set(frame)
    heads = {bone.name: body.matrix_world @ bone.head for bone in body.pose.bones}
    found.append({name: [at.x, at.z, -at.y] for name, at in heads.items()})
print("HEADS" + json.dumps(found))
"""


def written(skeleton, **params):
    return views.files(glb(skeleton, GlbParams(**{"scale": 1.0, **params})), ())["skeleton.glb"]


def read(skeleton, **params):
    return Read(written(skeleton, **params))


@pytest.fixture(scope="module")
def body():
    return spider()


def test_mesh_read_back_moves_as_the_skeleton_says_in_every_frame(body):
    file, truth = read(body), skinned(body)
    size = np.linalg.norm(np.ptp(body.vertices, axis=0))
    for t in range(len(body.frames)):
        assert np.abs(file.skinned(t) - truth[t]).max() < 2e-6 * size


def test_joints_read_back_are_where_the_skeleton_has_them(body):
    file = read(body)
    for t in range(len(body.frames)):
        np.testing.assert_allclose(file.pose(t)[:, :3, 3], body.positions[t], atol=2e-5)


def test_file_at_rest_is_the_reference_mesh(body):
    file = read(body)
    np.testing.assert_allclose(file.skinned(), body.vertices, atol=2e-5)
    np.testing.assert_allclose(file.pose()[:, :3, 3], body.rest, atol=2e-5)
    np.testing.assert_array_equal(file.faces, body.faces)


def test_every_joint_points_along_its_bone_at_rest(body):
    rest, y = body.rest, read(body).pose()[:, :3, 1]
    leads = {0: 4, 1: 2, 4: 5}  # the child with the longest bones, all below it counted
    for joint, child in leads.items():
        along = rest[child] - rest[joint]
        np.testing.assert_allclose(y[joint], along / np.linalg.norm(along), atol=1e-6)
    np.testing.assert_allclose(y[2], y[1], atol=1e-6)


def test_influences_are_at_most_four_and_sum_to_one(body):
    file = read(body)
    weight, joint = file.attribute("WEIGHTS_0"), file.attribute("JOINTS_0")
    assert weight.shape[1] == joint.shape[1] == 4
    np.testing.assert_allclose(weight.sum(axis=1, dtype=np.float64), 1.0, atol=1e-6)
    assert not joint[weight == 0].any()


def test_keys_keep_the_time_of_frames_that_were_left_out(body):
    file = read(spider(frames=(4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 20, 30)))
    np.testing.assert_allclose(file.times, [0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.6, 2.6], rtol=1e-6)
    assert file.json["asset"]["extras"]["frames"][-2:] == [20, 30]


def test_unknown_pace_is_thirty_frames_a_second_and_said_to_be_a_guess():
    unknown = spider(fps=None, unit=None)
    assert read(unknown).times[-1] == pytest.approx(11 / 30)
    assert read(unknown).json["asset"]["extras"]["fps_is_assumed"] is True
    rate, size = views.remarks(glb(unknown, GlbParams()))
    assert "30 frames a second assumed" in rate
    assert "one unit is assumed to be 1 m" in size


def test_body_in_mm_is_life_size_and_what_is_said_goes_before_the_unit(body):
    assert glb(body, GlbParams()).scale == 0.001
    assert views.remarks(glb(body, GlbParams())) == ()
    assert glb(body, GlbParams(scale=2.0)).scale == 2.0
    assert views.remarks(glb(spider(unit="ell"), GlbParams())) == (
        "unit not known: one unit is assumed to be 1 m; set sequence.unit or glb.scale",
    )


def test_turns_of_a_joint_take_the_short_way_from_key_to_key(body):
    file = read(body)
    for channel in file.json["animations"][0]["channels"]:
        if channel["target"]["path"] == "rotation":
            q = file.array(file.json["animations"][0]["samplers"][channel["sampler"]]["output"])
            assert (np.sum(q[1:] * q[:-1], axis=1) >= 0).all()


def test_names_are_kept_whatever_they_are():
    names = ("a b", "<script>alert(1)</script>", "línea\n2", "關節", '"', "\\", "c")
    assert read(spider(names=names)).names == list(names)


@pytest.mark.parametrize(("up", "axis"), [("x", 0), ("y", 1), ("z", 2)])
@pytest.mark.parametrize("sign", [1, -1])
def test_axis_that_is_said_to_point_up_does_and_nothing_is_mirrored(body, up, axis, sign):
    file = read(body, up="-" * (sign < 0) + up, scale=0.5)
    X, Y = body.positions[3], file.pose(3)[:, :3, 3]
    np.testing.assert_allclose(Y[:, 1], 0.5 * sign * X[:, axis], atol=2e-5)
    turn = np.linalg.lstsq(X - X[0], Y - Y[0], rcond=None)[0]
    np.testing.assert_allclose(turn @ turn.T, 0.25 * np.eye(3), atol=1e-5)
    assert np.linalg.det(turn) > 0


def test_parts_are_coloured_and_what_blends_is_white(body):
    file = read(body)
    colour = file.attribute("COLOR_0")
    assert (colour[body.label == -1] == 255).all()
    seen = [colour[body.label == part] for part in set(body.label.tolist()) - {-1}]
    assert all(len(np.unique(rows, axis=0)) == 1 for rows in seen)
    assert len(np.unique([rows[0] for rows in seen], axis=0)) == len(seen)


def test_body_without_joints_is_written_too(body):
    still = spider(
        names=("all",), parents=(-1,), kinds=("root",), positions=body.positions[:, :1], rotation=body.rotation[:, :1],
        confidence=body.confidence[:, :1], rest=body.rest[:1], degrees=[0.0], drift=[0.0], support=body.support[:1],
        label=np.zeros_like(body.label), influence=np.zeros_like(body.influence), weight=np.eye(4)[0 * body.label],
    )  # fmt: skip
    t = 5
    R, x = body.rotation[t, 0], body.positions[t, 0]
    np.testing.assert_allclose(read(still).skinned(t), (body.vertices - body.rest[0]) @ R.T + x, atol=3e-5)


def test_same_skeleton_gives_the_same_bytes(body):
    assert written(body) == written(spider())


def test_khronos_validator_has_nothing_to_say(body, tmp_path):
    modules = os.pathsep.join([str(ROOT / ".venv" / "node_modules"), os.environ.get("NODE_PATH", "")])
    environment = {**os.environ, "NODE_PATH": modules}
    node = shutil.which("node")
    if (
        node is None
        or subprocess.run([node, "-e", 'require("gltf-validator")'], env=environment, capture_output=True).returncode
    ):
        pytest.skip("npm install gltf-validator brings the Khronos validator")
    (tmp_path / "validate.js").write_text(VALIDATE)
    for number, skeleton in enumerate([body, spider(names=tuple("<&> \n'é"), fps=None)]):
        (tmp_path / f"{number}.glb").write_bytes(written(skeleton, up="z", scale=0.01 if number else 1.0))
        command = [node, str(tmp_path / "validate.js"), str(tmp_path / f"{number}.glb")]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
        assert json.loads(done.stdout)["messages"] == []


def test_blender_has_bones_where_the_joints_are(body, tmp_path):
    python = os.environ.get("BLENDER_PYTHON") or (sys.executable if importlib.util.find_spec("bpy") else None)
    if python is None:
        pytest.skip("pip install bpy brings Blender, or BLENDER_PYTHON names a Python that has it")
    (tmp_path / "body.glb").write_bytes(written(body))
    (tmp_path / "blender.py").write_text(BLENDER)
    command = [python, str(tmp_path / "blender.py"), str(tmp_path / "body.glb"), "10", str(len(body.frames))]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    file = json.loads(next(line for line in done.stdout.splitlines() if line.startswith("HEADS"))[5:])
    for t, heads in enumerate(file):
        assert set(heads) == set(body.names)
        np.testing.assert_allclose([heads[name] for name in body.names], body.positions[t], atol=1e-3)
