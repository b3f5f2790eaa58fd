"""Spellings of names."""

import pytest

from kinetree.tasks.numerics.structure.anatomical_names import Named
from kinetree.tasks.numerics.structure.name_styles import STYLES, styled_names

NAMES = [Named("pelvis"), Named("shoulder", "l"), Named("knee", "r"), None, Named("tail_1")]
GIVEN = ("root", "limb_a_1", "limb_b_2", "limb_c_1", "limb_d_1")


def styled(style, sides=("_l", "_r"), rename=None):
    return styled_names(NAMES, GIVEN, style, sides, rename or {})


@pytest.mark.parametrize(
    ("style", "names"),
    [
        ("kinetree", ("pelvis", "shoulder_l", "knee_r")),
        ("mixamo", ("mixamorig:Hips", "mixamorig:LeftArm", "mixamorig:RightLeg")),
        ("smpl", ("pelvis", "left_shoulder", "right_knee")),
        ("openpose", ("MidHip", "LShoulder", "RKnee")),
        ("vrm", ("hips", "leftUpperArm", "rightLowerLeg")),
        ("isb", ("pelvis", "GH_L", "KJC_R")),
    ],
)
def test_every_style_has_its_spelling_and_unknown_joints_keep_their_names(style, names):
    assert styled(style) == (*names, "limb_c_1", "tail_1")


def test_sides_are_spelled_as_they_are_asked_for():
    assert styled("kinetree", (".L", ".R"))[1:3] == ("shoulder.L", "knee.R")


def test_names_may_be_replaced_by_either_name_and_stay_unique():
    assert styled("kinetree", rename={"limb_c_1": "jaw", "knee_r": "shoulder_l"}) == (
        "pelvis", "shoulder_l", "shoulder_l_2", "jaw", "tail_1",
    )  # fmt: skip


@pytest.mark.parametrize("style", STYLES)
def test_no_style_gives_two_stations_of_one_body_one_name(style):
    names = STYLES[style][1]
    once = [text for station, text in names.items() if station not in ("torso", "spine")]
    assert len(set(once)) == len(once)
