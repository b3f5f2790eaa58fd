"""Truth files of three formats: what is read, and what is refused."""

import json

import numpy as np
import pytest

from kinetree.errors import InputError
from kinetree.tasks.numerics.results.truth import read_truth, truth_of_json

CONTENT = {
    "unit": "mm",
    "height": 1500.0,
    "joints": [
        {"name": "hips", "parent": None, "kind": "joint", "turns_deg": 0.0, "scored": False},
        {"name": "knee", "parent": "hips", "kind": "joint", "turns_deg": 40.0, "scored": True},
        {"name": "toe", "parent": "knee", "kind": "tip", "turns_deg": 0.0, "scored": False},
    ],
    "positions": np.arange(18.0).reshape(2, 3, 3).tolist(),
}


def changed(**fields):
    return json.dumps({**CONTENT, **fields})


def joints(**fields):
    return [CONTENT["joints"][0], {**CONTENT["joints"][1], **fields}, CONTENT["joints"][2]]


def test_joints_that_another_run_assumed_are_left_out():
    rows = [CONTENT["joints"][0], {"name": "thigh", "parent": "hips", "kind": "assumed"}]
    rows += [{**CONTENT["joints"][1], "parent": "thigh"}, CONTENT["joints"][2]]
    X = np.arange(24.0).reshape(2, 4, 3)
    truth = truth_of_json({**CONTENT, "joints": rows, "positions": X.tolist()}, "skeleton.json")
    assert (truth.names, truth.parents) == (("hips", "knee", "toe"), (-1, 0, 1))
    assert np.array_equal(truth.X, X[:, [0, 2, 3]])
    with pytest.raises(InputError, match="hips has kind 'assumed'"):
        truth_of_json({**CONTENT, "joints": [{**CONTENT["joints"][0], "kind": "assumed"}, *CONTENT["joints"][1:]]}, "t")


def test_truth_json_is_read():
    truth = read_truth(json.dumps(CONTENT), "truth.json")
    assert truth.names == ("hips", "knee", "toe")
    assert truth.parents == (-1, 0, 1)
    assert truth.kinds == ("joint", "joint", "tip")
    assert truth.scored == (False, True, False)
    assert truth.frames == (0, 1)
    assert (truth.height, truth.unit, truth.fps) == (1500.0, "mm", None)
    assert np.array_equal(truth.X, np.arange(18.0).reshape(2, 3, 3))


@pytest.mark.parametrize("version", [1, 2])
def test_skeleton_json_of_another_run_is_a_truth_too(version):
    content = {
        "format": f"kinetree.skeleton/{version}",
        "unit": None,
        "fps": 25.0,
        "frames": [3, 5],
        "joints": [
            {"name": "a", "parent": None, "kind": "root"},
            {"name": "b", "parent": 0, "kind": "joint"},
            {"name": "c", "parent": 1, "kind": "leaf"},
        ],
        "positions": CONTENT["positions"],
    }
    truth = truth_of_json(content, "skeleton.json")
    assert truth.parents == (-1, 0, 1)
    assert truth.scored == (False, True, False)
    assert truth.frames == (3, 5)
    with pytest.raises(InputError, match=r"format 'kinetree\.skeleton/9' is not known; kinetree\.skeleton/1 and .*/2 are"):
        truth_of_json({**content, "format": "kinetree.skeleton/9"}, "skeleton.json")


def test_joint_that_turns_too_little_is_not_scored_where_the_file_does_not_say():
    rows = [{k: v for k, v in row.items() if k != "scored"} for row in joints(turns_deg=14.9)]
    assert truth_of_json({**CONTENT, "joints": rows}, "t").scored == (False, False, False)


def test_bvh_scores_what_turns_and_never_the_root():
    text = (
        "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 3 Zrotation Xrotation Yrotation\n"
        "JOINT b\n{\nOFFSET 0 1 0\nCHANNELS 3 Zrotation Xrotation Yrotation\n"
        "JOINT c\n{\nOFFSET 0 1 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nEnd Site\n{\nOFFSET 0 1 0\n}\n}\n}\n}\n"
        "MOTION\nFrames: 2\nFrame Time: 0.02\n0 0 0 0 0 0 0 0 0\n90 0 0 30 0 0 0 10 0\n"
    )
    truth = read_truth(text, "walk.BVH")
    assert truth.scored == (False, True, False, False)
    assert truth.turns == pytest.approx((90.0, 30.0, 10.0, 0.0))
    assert truth.kinds == ("joint", "joint", "joint", "tip")
    assert truth.fps == pytest.approx(50.0)
    assert truth.height is None


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "truth.json: not JSON: "),
        ("[]", "it has no joints and positions"),
        ('{"joints": []}', "it has no joints and positions"),
        (changed(joints=[]), "joints must be a list of objects, each with a name"),
        (changed(joints=joints(name="hips")), "two joints are called 'hips'"),
        (changed(joints=joints(parent="hip")), "the parent of knee is 'hip', which is none of its joints"),
        (changed(joints=joints(parent=None)), "2 joints have no parent; a tree has exactly one root"),
        (changed(joints=joints(parent="toe")), "knee is its own ancestor; joints must form a tree"),
        (changed(joints=joints(kind="ball")), "knee has kind 'ball'; expected one of root, joint, tip, leaf"),
        (changed(joints=joints(turns_deg="many")), "turns_deg of knee is 'many', which is not a finite number"),
        (changed(positions=[[[0, 0, 0]]]), "positions must be (frame, 3 joints, 3), got (1, 1, 3)"),
        (changed(positions=[]), "positions must be (frame, 3 joints, 3)"),
        (changed(positions=[[[0, 0, 0]] * 3, [[0, 0, 0]] * 2]), "equally many in every frame"),
        (changed(positions=[[[0, 0, 0]] * 3, [[0, 0, 0], [0, float("nan"), 0], [0, 0, 0]]]), "joint 1 in frame 1 is not"),
        (changed(height=0), "height is 0; expected a positive number"),
        (changed(fps=-25), "fps is -25; expected a positive number"),
        (changed(height=10**400), "not JSON: a number of 401 digits"),
        (changed(height=1e-300), "height is 1e-300; expected a positive number from 1e-50 to 1e+50"),
        (changed(joints=joints(kind=["tip"])), "knee has kind ['tip']; expected one of root, joint, tip, leaf"),
        (changed(joints=joints(parent=True)), "the parent of knee is True, which is none of its joints"),
        (changed(positions=[[[0, 0, 0]] * 3, [[0, 0, 0], [0, 1e200, 0], [0, 0, 0]]]), "positions go up to 1e+200"),
        ("[" * 100_000, "lists are nested too deeply"),
        (changed(frames=[0]), "frames must be 2 whole numbers"),
        (changed(frames=[4, 4]), "frames must ascend"),
    ],
)
def test_invalid_truth_is_refused_in_words(text, message):
    with pytest.raises(InputError) as refused:
        read_truth(text, "truth.json")
    assert message in str(refused.value)
    assert str(refused.value).startswith("truth.json")


def test_file_of_another_kind_is_refused():
    with pytest.raises(InputError, match=r"walk\.c3d: a truth is a truth\.json, .* or a \.bvh file"):
        read_truth("", "walk.c3d")
