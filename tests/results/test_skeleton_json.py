"""skeleton.json and its published schema."""

import json

import numpy as np
import pytest
from pydantic import ValidationError
from results.plain_names import plain
from results.rigged_bodies import bars_of, spider
from scipy.spatial.transform import Rotation

from kinetree.pipeline import views
from kinetree.schemas.results.complete_skeleton import CompleteSkeleton
from kinetree.schemas.results.skeleton_json import Document
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.results.formats.document import schema
from kinetree.tasks.results.skeleton_json import skeleton_json
from kinetree.tasks.structure.error_bars import unknown_error_bars


@pytest.fixture
def body():
    return spider()


Z_UP = UpDirection(up="z", confidence=0.9)


def text(skeleton, names=None, bars=None):
    fields = {name: getattr(skeleton, name) for name in Skeleton.model_fields}
    complete = CompleteSkeleton(**fields, interpolated=())
    made = skeleton_json(complete, names or plain(skeleton), Z_UP, bars or unknown_error_bars(skeleton))
    return views.files(made, ())["skeleton.json"].decode()


def test_file_holds_the_skeleton_as_it_is(body):
    content = json.loads(text(body))
    assert list(content) == [
        "format", "unit", "fps", "up", "up_confidence", "topology", "front", "front_confidence", "frames", "seconds", "joints",
        "positions", "rotations", "bones", "confidence", "errors", "interpolated",
    ]  # fmt: skip
    assert content["format"] == "kinetree.skeleton/2"
    assert (content["unit"], content["fps"], content["up"], content["frames"]) == ("mm", 10.0, "z", list(range(12)))
    np.testing.assert_allclose(content["seconds"], np.arange(12) / 10)
    joint = content["joints"][2]
    assert (joint["name"], joint["parent"], joint["kind"]) == ("hand", 1, "leaf")
    assert content["joints"][0]["parent"] is None
    assert [joint["range"] for joint in content["joints"]] == body.degrees.tolist()
    np.testing.assert_array_equal(content["positions"], body.positions)
    np.testing.assert_array_equal(content["confidence"], body.confidence)


def test_rotations_and_rest_pose_carry_every_joint_to_its_position(body):
    content = json.loads(text(body))
    rest = [joint["rest"] for joint in content["joints"]]
    for t, quaternions in [(None, [r["rotation"] for r in rest]), *enumerate(content["rotations"])]:
        X, G = [], []
        for joint, pose, q in zip(content["joints"], rest, quaternions, strict=True):
            p, local = joint["parent"], Rotation.from_quat(q).as_matrix()
            root = pose["position"] if t is None else content["positions"][t][0]
            X.append(np.array(root) if p is None else X[p] + G[p] @ pose["offset"])
            G.append(local if p is None else G[p] @ local)
        expected = body.rest if t is None else body.positions[t]
        np.testing.assert_allclose(X, expected, atol=1e-6)


def test_what_a_joint_is_stands_beside_its_name(body):
    names = plain(
        body, names=tuple("abcdefg"), anatomy=("pelvis", "", "", "", "knee_l", "", ""), topology="human", front=(0, -1, 0),
        front_confidence=0.75,
    )  # fmt: skip
    content = json.loads(text(body, names))
    assert [(joint["name"], joint["anatomy"]) for joint in content["joints"]][3:5] == [("d", None), ("e", "knee_l")]
    assert (content["topology"], content["front"], content["front_confidence"]) == ("human", [0, -1, 0], 0.75)
    assert json.loads(text(body))["front"] is None


def test_time_is_null_where_nobody_knows_it():
    assert json.loads(text(spider(fps=None)))["seconds"] is None


def test_bones_are_as_long_as_the_way_between_their_joints_in_every_frame(body):
    content = json.loads(text(body))
    X = np.array(content["positions"])
    assert [bone["child"] for bone in content["bones"]] == [1, 2, 3, 4, 5, 6]
    for bone in content["bones"]:
        np.testing.assert_allclose(np.linalg.norm(X[:, bone["child"]] - X[:, bone["parent"]], axis=1), bone["length"])


def test_file_follows_the_published_schema_and_a_wrong_one_does_not(body):
    jsonschema = pytest.importorskip("jsonschema", reason="pip install jsonschema brings the validator")
    content = json.loads(text(spider(fps=None, unit=None)))
    jsonschema.Draft202012Validator.check_schema(schema())
    jsonschema.validate(content, schema())
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({**content, "joints": [{"name": "a", "parent": None, "kind": "wing"}]}, schema())
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({**content, "more": 1}, schema())


def test_model_reads_what_was_written(body):
    assert Document.model_validate_json(text(body)).model_dump(mode="json") == json.loads(text(body))
    with pytest.raises(ValidationError):
        Document.model_validate({**json.loads(text(body)), "fps": 0})


def test_names_are_kept_whatever_they_are_and_the_file_is_ascii():
    names = ("a b", "<script>alert(1)</script>", "línea\n2", "關節", '"', "\\", "c")
    content = text(spider(names=names))
    assert [joint["name"] for joint in json.loads(content)["joints"]] == list(names)
    assert content.isascii()


def test_expected_errors_stand_with_their_joints_and_in_every_frame(body):
    bars = bars_of(body)
    content = json.loads(text(body, bars=bars))
    assert Document.model_validate(content)
    for j, joint in enumerate(content["joints"]):
        if body.kinds[j] != "joint":
            assert joint["error"] is None
            assert {row[j] for row in content["errors"]} == {None}
            continue
        assert joint["error"]["expected"] == bars.expected[j]
        assert joint["error"]["bound"] == bars.bound[j]
        assert joint["error"]["surface_offset"] == pytest.approx(bars.surface_offset[j], rel=1e-2)
        assert joint["error"]["asymmetry"] == pytest.approx(bars.asymmetry[j], rel=1e-2)
        assert (joint["error"]["cuts"], joint["error"]["agreeing"], joint["error"]["support"]) == (4, 3, 12)
        np.testing.assert_allclose([row[j] for row in content["errors"]], bars.in_frame[:, j], rtol=1e-3)


def test_spread_of_a_joint_that_one_cut_has_its_offset_where_there_is_none_and_a_frame_that_was_not_measured_are_null(body):
    bars = bars_of(body)
    unknown = dict.fromkeys(("spread", "surface_offset", "asymmetry"), np.full_like(bars.spread, np.nan))
    lacking = bars.model_copy(update={**unknown, "frames": bars.frames[1:], "in_frame": bars.in_frame[1:]})
    content = json.loads(text(body, bars=lacking))
    j = body.kinds.index("joint")
    assert content["joints"][j]["error"]["spread"] is None
    assert content["joints"][j]["error"]["surface_offset"] is None
    assert content["joints"][j]["error"]["asymmetry"] is None
    assert content["errors"][0][j] is None
    assert content["errors"][1][j] is not None


def test_files_without_expected_errors_are_still_read(body):
    content = json.loads(text(body))
    assert content["errors"] is None
    assert (
        {joint.pop("error") for joint in content["joints"]} == {joint.pop("evidence") for joint in content["joints"]} == {None}
    )
    del content["errors"]
    assert Document.model_validate(content).errors is None


def test_joints_say_whether_motion_or_the_shape_alone_shows_them(body):
    j = body.kinds.index("joint")
    bars = bars_of(body)
    alone = bars.model_copy(update={"evidence": tuple("shape" if k == j else known for k, known in enumerate(bars.evidence))})
    content = json.loads(text(body, bars=alone))
    assert Document.model_validate(content)
    of_kind = {kind: {joint["evidence"] for joint in content["joints"] if joint["kind"] == kind} for kind in body.kinds}
    assert of_kind == {"root": {None}, "joint": {"motion", "shape"}, "leaf": {None}}
    assert content["joints"][j]["evidence"] == "shape"
    assert {joint["evidence"] for joint in json.loads(text(body))["joints"]} == {None}
