"""What is read from a truth, and what is refused."""

import json

import numpy as np
import pytest

from kinetree.errors import InputError
from kinetree.tasks.numerics.results.evaluation.truth import factor, of_told, read_truth

TOLD = {
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
    return json.dumps({**TOLD, **fields})


def joints(**fields):
    return [TOLD["joints"][0], {**TOLD["joints"][1], **fields}, TOLD["joints"][2]]


def test_what_is_told_is_read():
    truth = read_truth(json.dumps(TOLD), "truth.json")
    assert truth.names == ("hips", "knee", "toe")
    assert truth.parents == (-1, 0, 1)
    assert truth.kinds == ("joint", "joint", "tip")
    assert truth.scored == (False, True, False)
    assert truth.frames == (0, 1)
    assert (truth.height, truth.unit, truth.fps) == (1500.0, "mm", None)
    assert np.array_equal(truth.X, np.arange(18.0).reshape(2, 3, 3))


def test_skeleton_json_of_another_run_is_a_truth_too():
    told = {
        "format": "kinetree.skeleton/1",
        "unit": None,
        "fps": 25.0,
        "frames": [3, 5],
        "joints": [
            {"name": "a", "parent": None, "kind": "root"},
            {"name": "b", "parent": 0, "kind": "joint"},
            {"name": "c", "parent": 1, "kind": "leaf"},
        ],
        "positions": TOLD["positions"],
    }
    truth = of_told(told, "skeleton.json")
    assert truth.parents == (-1, 0, 1)
    assert truth.scored == (False, True, False)
    assert truth.frames == (3, 5)
    with pytest.raises(InputError, match=r"format 'kinetree\.skeleton/9' is not known; kinetree\.skeleton/1 is"):
        of_told({**told, "format": "kinetree.skeleton/9"}, "skeleton.json")


def test_joint_that_turns_too_little_is_not_scored_where_the_file_does_not_say():
    rows = [{k: v for k, v in row.items() if k != "scored"} for row in joints(turns_deg=14.9)]
    assert of_told({**TOLD, "joints": rows}, "t").scored == (False, False, False)


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
    ("text", "told"),
    [
        ("{", "truth.json: not JSON: "),
        ("[]", "no joints and positions in it"),
        ('{"joints": []}', "no joints and positions in it"),
        (changed(joints=[]), "joints must be a list of objects, each with a name"),
        (changed(joints=joints(name="hips")), "two joints are called 'hips'"),
        (changed(joints=joints(parent="hip")), "the parent of knee is 'hip', which is none of its joints"),
        (changed(joints=joints(parent=None)), "2 joints have no parent; one tree has one root"),
        (changed(joints=joints(parent="toe")), "knee is below itself; joints must make a tree"),
        (changed(joints=joints(kind="ball")), "knee is a 'ball'; there are root, joint, tip, leaf"),
        (changed(joints=joints(turns_deg="many")), "turns_deg of knee is 'many', which is no number"),
        (changed(positions=[[[0, 0, 0]]]), "positions must be (frame, 3 joints, 3), got (1, 1, 3)"),
        (changed(positions=[]), "positions must be (frame, 3 joints, 3)"),
        (changed(positions=[[[0, 0, 0]] * 3, [[0, 0, 0]] * 2]), "the same for every frame"),
        (changed(positions=[[[0, 0, 0]] * 3, [[0, 0, 0], [0, float("nan"), 0], [0, 0, 0]]]), "joint 1 in frame 1 is not"),
        (changed(height=0), "height is 0, expected a number above 0"),
        (changed(fps=-25), "fps is -25, expected a number above 0"),
        (changed(height=10**400), "height is 1000000000000000000000000000000000000000, which is no number"),
        (changed(height=1e-300), "height is 1e-300, expected a number above 0 of a size that occurs"),
        (changed(joints=joints(kind=["tip"])), "knee is a ['tip']; there are root, joint, tip, leaf"),
        (changed(joints=joints(parent=True)), "the parent of knee is True, which is none of its joints"),
        (changed(positions=[[[0, 0, 0]] * 3, [[0, 0, 0], [0, 1e200, 0], [0, 0, 0]]]), "positions go up to 1e+200"),
        ("[" * 100_000, "lists within lists without end"),
        (changed(frames=[0]), "frames must be 2 whole numbers"),
        (changed(frames=[4, 4]), "frames must ascend"),
    ],
)
def test_what_is_no_truth_is_refused_in_words(text, told):
    with pytest.raises(InputError) as refused:
        read_truth(text, "truth.json")
    assert told in str(refused.value)
    assert str(refused.value).startswith("truth.json")


def test_file_of_another_kind_is_refused():
    with pytest.raises(InputError, match=r"walk\.c3d: a truth is a truth\.json, .* or a \.bvh file"):
        read_truth("", "walk.c3d")


def test_units_are_converted_where_both_are_known():
    assert factor("m", "mm", "t") == pytest.approx(1000.0)
    assert factor("cm", None, "t") == factor(None, "cm", "t") == factor("ell", "ell", "t") == 1.0
    with pytest.raises(InputError, match="t is in ell and the sequence in mm; ell is none of mm, cm"):
        factor("ell", "mm", "t")
