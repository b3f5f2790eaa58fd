"""skeleton.bvh, read back joint by joint by a parser that is not ours."""

import numpy as np
import pytest
from results.plain_names import plain
from results.rigged_bodies import spider
from scipy.spatial.transform import Rotation

from kinetree.pipeline import views
from kinetree.schemas.results.bvh import BvhParams
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.results.bvh import bvh
from kinetree.tasks.results.formats.bvh import continuous, euler_zxy

LEAVES = {"tail", "foot", "spur"}
"""Leaves beside other children, which are joints of the file; the hand, an only child, is its parent's end site."""


@pytest.fixture
def body():
    return spider()


UP = UpDirection(up="y", confidence=0.9)


def text(skeleton, up_direction=UP, **params):
    exported = bvh(skeleton, plain(skeleton), up_direction, BvhParams(**{"scale": 1.0, **params}))
    return views.files(exported, ())["skeleton.bvh"].decode()


def read(skeleton, folder, up_direction=UP, **params):
    pybvh = pytest.importorskip("pybvh", reason="pip install pybvh brings the parser")
    path = folder / "skeleton.bvh"
    path.write_text(text(skeleton, up_direction, **params))
    return pybvh.read_bvh_file(str(path))


def test_parser_finds_every_joint_where_the_skeleton_has_it_in_every_frame(body, tmp_path):
    result = read(body, tmp_path)
    at = result.node_positions()
    known = {node.name: number for number, node in enumerate(result.nodes)}
    known["hand"] = known["EndSitearm"]
    for joint, name in enumerate(body.names):
        np.testing.assert_allclose(at[:, known[name]], body.positions[:, joint], atol=1e-5)


@pytest.mark.parametrize(("wanted", "columns", "signs"), [("y", [0, 2, 1], [1, 1, -1]), ("z", [0, 1, 2], [1, 1, 1])])
def test_file_is_upright_and_in_centimetres(body, tmp_path, wanted, columns, signs):
    stands = UpDirection(up="z", confidence=0.9)
    result = read(body, tmp_path, stands, up=wanted, scale=None)
    at = result.node_positions()
    known = {node.name: number for number, node in enumerate(result.nodes)}
    for joint in (0, 1, 5):
        expected = body.positions[:, joint][:, columns] * signs / 10
        np.testing.assert_allclose(at[:, known[body.names[joint]]], expected, atol=1e-6)


def test_unknown_unit_is_guessed_from_the_size_and_said(body):
    exported = bvh(spider(unit=None), plain(spider(unit=None)), UP, BvhParams())
    assert "unit not known" in views.remarks(exported)[0]
    assert "bvh.scale" in views.remarks(exported)[0]
    assert views.remarks(bvh(spider(unit=None), plain(spider(unit=None)), UP, BvhParams(scale=1.0))) == ()


def test_parser_finds_the_pace(body, tmp_path):
    assert read(body, tmp_path).fps == pytest.approx(10.0)
    assert read(spider(fps=None), tmp_path).fps == pytest.approx(30.0)


def test_offsets_are_the_bones_of_the_reference_pose_and_the_root_has_none(body):
    offsets = [tuple(map(float, line.split()[1:])) for line in text(body).splitlines() if "OFFSET" in line]
    bones = {tuple(np.round(body.rest[j] - body.rest[p], 6)) for j, p in enumerate(body.parents) if p >= 0}
    assert offsets[0] == (0.0, 0.0, 0.0)
    assert set(offsets[1:]) - {(0.0, 0.0, 0.0)} == bones


def test_only_child_that_is_a_leaf_is_an_end_site_and_others_are_joints(body):
    content = text(body)
    assert "hand" not in content
    assert {name for name in LEAVES if f"JOINT {name}" in content} == LEAVES
    assert content.count("End Site") == 4


def test_names_are_single_words_still_unique(tmp_path):
    names = ("root\nJOINT x", "a b", "a\tb", "<script>", "é", "7", "")
    lines = text(spider(names=names)).splitlines()
    joints = [line.split(maxsplit=1)[1] for line in lines if line.split()[0] in ("ROOT", "JOINT")]
    assert len(set(joints)) == len(joints) == 6
    assert all(word.isascii() and word.isidentifier() for word in joints)
    assert read(spider(names=names), tmp_path).joint_count == len(joints)


def test_frames_left_out_are_put_in_between(body):
    gaps = spider(frames=(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 26))
    lines = text(gaps).splitlines()
    assert "Frames: 14" in lines
    assert "Frame Time: 0.2" in lines
    rows = np.array([list(map(float, line.split())) for line in lines[lines.index("Frame Time: 0.2") + 1 :]])
    np.testing.assert_allclose(rows[11:14, :3], np.linspace(rows[10, :3], rows[13, :3], 4)[1:], atol=1e-6)
    (remark,) = views.remarks(bvh(gaps, plain(gaps), UP, BvhParams()))
    assert "2 frames were interpolated" in remark
    assert views.remarks(bvh(body, plain(body), UP, BvhParams())) == ()


def test_angles_are_those_of_the_turns_even_where_two_axes_are_one():
    R = Rotation.random(50, random_state=1).as_matrix()
    level = Rotation.from_euler("ZXY", [[20, 90, 30], [-70, -90, 5]], degrees=True).as_matrix()
    every = np.concatenate([R, level])
    back = Rotation.from_euler("ZXY", euler_zxy(every), degrees=True).as_matrix()
    np.testing.assert_allclose(back, every, atol=1e-12)


def test_angles_go_on_through_half_turns_and_past_the_upright():
    angles = np.stack([np.linspace(0, 700, 60), np.linspace(0, 170, 60), np.linspace(0, -400, 60)], axis=1)[:, None]
    R = Rotation.from_euler("ZXY", angles[:, 0], degrees=True).as_matrix()[:, None]
    angles = continuous(euler_zxy(R))
    assert np.abs(np.diff(angles, axis=0)).max() < 20
    np.testing.assert_allclose(Rotation.from_euler("ZXY", angles[:, 0], degrees=True).as_matrix()[:, None], R, atol=1e-12)
