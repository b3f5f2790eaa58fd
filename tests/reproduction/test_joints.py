"""Table 2: the eight joints are found by their names, as files name them, and what is missing is said."""

import pytest
from results.rigged_bodies import spider
from results.sample_report import unjudged

from kinetree.errors import InputError
from kinetree.schemas.results.evaluation import Evaluation, JointScore
from kinetree.tasks.reproduction.joints import eight_joints, evaluation, side_of
from kinetree.tasks.reproduction.printed import TABLE_2

GENERATED = {
    "elbow": "elbow_{s}", "hand": "hand_{s}", "knee": "knee_{s}", "toe": "toe_{s}",
}  # fmt: skip
OF_A_BVH = {"elbow": "{Side}ForeArm", "hand": "{Side}Hand_End", "knee": "{Side}Leg", "toe": "{Side}ToeBase_End"}


def judged(joints: list[str], tips: list[str]) -> Evaluation:
    rows = [*(JointScore(name=name) for name in joints), *(JointScore(name=name, kind="tip") for name in tips)]
    return unjudged(spider()).model_copy(update={"truth": "walk.bvh", "height": 1500.0, "joints": tuple(rows)})


def named(names: dict[str, str]) -> dict[str, str]:
    return {
        f"{side} {what}": pattern.format(s=side[0], Side=side.capitalize())
        for what, pattern in names.items()
        for side in ("left", "right")
    }


def test_joints_of_a_generated_body_are_found_and_hands_and_toes_are_ends() -> None:
    names = named(GENERATED)
    joints = [n for name, n in names.items() if name.endswith(("elbow", "knee"))]
    tips = [n for name, n in names.items() if name.endswith(("hand", "toe"))]
    others = ["hips", "wrist_l", "wrist_r", "shoulder_l", "hip_l", "ankle_l", "ankle_r"]
    picked, height = eight_joints(judged([*others, *joints], ["heel_l", "heel_r", "head_top", *tips]))
    assert {name: row.name for name, row in picked.items()} == names
    assert list(picked) == list(TABLE_2)
    assert height == 1500


def test_joints_of_a_recording_are_found_by_its_names() -> None:
    names = named(OF_A_BVH)
    joints = ["LeftArm", "LeftHand", "RightHand", "LeftUpLeg", "RightUpLeg", "LeftFoot", "RightFoot", "LeftToeBase"]
    joints += [n for name, n in names.items() if name.endswith(("elbow", "knee"))]
    tips = [n for name, n in names.items() if name.endswith(("hand", "toe"))]
    picked, _ = eight_joints(judged(joints, tips))
    assert {name: row.name for name, row in picked.items()} == names


def test_a_fingertip_is_the_end_of_the_hand_and_goes_before_the_wrist() -> None:
    names = named({"elbow": "{Side}ForeArm", "hand": "{Side}Fingertip", "knee": "{Side}Leg", "toe": "{Side}ToeTip"})
    joints = ["LeftHand", "RightHand", "LeftHandFinger1", "RightHandFinger1", "LeftFoot", "RightFoot"]
    joints += [n for name, n in names.items() if name.endswith(("elbow", "knee"))]
    picked, _ = eight_joints(judged(joints, [n for name, n in names.items() if name.endswith(("hand", "toe"))]))
    assert {name: row.name for name, row in picked.items()} == names


def test_wrist_and_foot_stand_in_where_no_end_is_named() -> None:
    names = {"elbow": "{Side}Elbow", "hand": "{Side}Wrist", "knee": "{Side}Knee", "toe": "{Side}Foot"}
    picked, _ = eight_joints(judged(list(named(names).values()), []))
    assert {name: row.name for name, row in picked.items()} == named(names)


def test_truth_that_lacks_a_joint_is_refused_by_name() -> None:
    names = [n for name, n in named(GENERATED).items() if name != "left knee"]
    with pytest.raises(InputError, match=r"walk\.bvh: .* no joint is named as left knee; the truth has elbow_l, "):
        eight_joints(judged(names, []))


@pytest.mark.parametrize(
    ("name", "side"),
    [("elbow_l", "left"), ("foot.R", "right"), ("RightHand", "right"), ("lToe", "left"), ("mixamorig:LeftLeg", "left"),
     ("hips", None), ("collar", None), ("L_Elbow", "left"), ("RElbow", "right")],
)  # fmt: skip
def test_side_is_a_word_of_the_name_and_no_letter_in_it(name: str, side: str | None) -> None:
    assert side_of(name) == side


def test_run_without_a_truth_is_refused() -> None:
    class Run:
        def fetch(self, name: str) -> Evaluation:
            return unjudged(spider())

    with pytest.raises(InputError, match="no true skeleton is known of this input; .* --truth FILE"):
        evaluation(Run())  # type: ignore[arg-type]
