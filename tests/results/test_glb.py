"""skeleton.glb, read back by a reader of its own and by the Khronos validator; test_blender.py opens it in Blender."""

import numpy as np
import pytest
from results.gltf_reader import Glb as Read
from results.gltf_validator import issues
from results.plain_names import plain
from results.rigged_bodies import skinned, spider

from kinetree.pipeline import views
from kinetree.schemas.results.glb import GlbParams
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.numerics.input.animated import read_animated
from kinetree.tasks.results.formats.placement import placed
from kinetree.tasks.results.glb import glb

Y_UP = UpDirection(up="y", confidence=0.9)


def written(skeleton, up_direction=Y_UP, **params):
    return views.files(glb(skeleton, plain(skeleton), up_direction, GlbParams(**{"scale": 1.0, **params})), ())["skeleton.glb"]


def read(skeleton, up_direction=Y_UP, **params):
    return Read(written(skeleton, up_direction, **params))


@pytest.fixture(scope="module")
def body():
    return spider()


def test_mesh_read_back_moves_as_the_skeleton_says_in_every_frame(body):
    file, truth = read(body), skinned(body)
    size = np.linalg.norm(np.ptp(body.vertices, axis=0))
    for t in range(len(body.frames)):
        assert np.abs(file.skinned(t) - truth[t]).max() < 2e-6 * size


def test_glb_is_a_sequence_to_begin_with(body, tmp_path):
    """What is exported goes in again, surface and motion the same."""
    (tmp_path / "skeleton.glb").write_bytes(written(body))
    frames, truth = read_animated(tmp_path / "skeleton.glb"), skinned(body)
    size = np.linalg.norm(np.ptp(body.vertices, axis=0))
    assert frames.fps == body.fps
    for t in range(len(frames)):
        X, F = frames.mesh(t)
        assert np.abs(X - truth[t]).max() < 2e-6 * size
        np.testing.assert_array_equal(F, body.faces)


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
    (rate,) = views.remarks(glb(spider(fps=None), plain(spider(fps=None)), Y_UP, GlbParams()))
    assert "30 frames a second assumed" in rate


def test_body_in_mm_is_life_size_and_what_is_said_goes_before_the_unit(body):
    np.testing.assert_allclose(read(body, scale=None).pose(3)[:, :3, 3], body.positions[3] / 1000, atol=1e-8)
    np.testing.assert_allclose(read(body, scale=None).skinned(3), skinned(body)[3] / 1000, atol=1e-7)
    assert views.remarks(glb(body, plain(body), Y_UP, GlbParams())) == ()
    assert glb(body, plain(body), Y_UP, GlbParams(scale=2.0)).metres == 2.0


@pytest.mark.parametrize(("size", "unit", "metres"), [(0.1, "m", 1.0), (10, "cm", 0.01), (100, "mm", 0.001)])
def test_unknown_unit_is_guessed_from_the_size_of_the_body_and_said(body, size, unit, metres):
    unknown = placed(body, np.eye(3), size).model_copy(update={"unit": "ell"})
    exported = glb(unknown, plain(unknown), Y_UP, GlbParams())
    assert (exported.metres, exported.metres_from) == (metres, "size")
    assert views.remarks(exported) == (
        f"unit 'ell' is not known: by the size of the body, one unit is taken for 1 {unit}; set sequence.unit or glb.scale",
    )


def test_up_is_what_the_run_found_and_glb_up_goes_before_it(body):
    estimate = UpDirection(up="z", confidence=0.1)
    np.testing.assert_allclose(read(body, estimate).pose(3)[:, 1, 3], body.positions[3][:, 2], atol=2e-5)
    assert views.remarks(glb(body, plain(body), estimate, GlbParams())) == (
        "up direction not certain: z of the input is taken to point up; set up_direction.up",
    )
    np.testing.assert_allclose(read(body, estimate, up="x").pose(3)[:, 1, 3], body.positions[3][:, 0], atol=2e-5)
    assert views.remarks(glb(body, plain(body), estimate, GlbParams(up="x"))) == ()


def test_nothing_above_the_joints_rotates_or_scales_them(body):
    file = read(body, up="z", scale=None)
    nodes = file.json["nodes"]
    assert nodes[0] == {"name": "skeleton", "children": [1]}
    assert nodes[-1] == {"name": "body", "mesh": 0, "skin": 0}
    assert not any("scale" in node for node in nodes)
    size = np.ptp(file.attribute("POSITION"), axis=0)
    np.testing.assert_allclose(size, np.ptp(body.vertices, axis=0)[[0, 2, 1]] / 1000, rtol=1e-5)


def test_body_faces_the_viewer_where_its_front_is_certain(body):
    for confidence, expected in ((0.9, body.positions[3] @ [[0, 0, 1], [0, 1, 0], [-1, 0, 0]]), (0.1, body.positions[3])):
        names = plain(body, front=(1, 0, 0), front_confidence=confidence)
        file = Read(views.files(glb(body, names, Y_UP, GlbParams(scale=1.0)), ())["skeleton.glb"])
        np.testing.assert_allclose(file.pose(3)[:, :3, 3], expected, atol=2e-5)


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
    of_part = [colour[body.label == part] for part in set(body.label.tolist()) - {-1}]
    assert all(len(np.unique(rows, axis=0)) == 1 for rows in of_part)
    assert len(np.unique([rows[0] for rows in of_part], axis=0)) == len(of_part)


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
    for number, skeleton in enumerate([body, spider(names=tuple("<&> \n'é"), fps=None)]):
        (tmp_path / f"{number}.glb").write_bytes(written(skeleton, up="z", scale=0.01 if number else 1.0))
        assert issues(tmp_path / f"{number}.glb")["messages"] == []
