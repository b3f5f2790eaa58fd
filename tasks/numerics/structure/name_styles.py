"""Anatomical names in the spellings of other programs and body models (ours)."""

from collections.abc import Mapping, Sequence
from typing import Literal

from kinetree.tasks.numerics.structure.anatomical_names import Named

Style = Literal["kinetree", "mixamo", "smpl", "openpose", "vrm", "isb"]
STYLES: Mapping[str, tuple[str, Mapping[str, str]]] = {
    "mixamo": ("mixamorig:{side}{name}", {
        "pelvis": "Hips", "torso": "Hips", "spine": "Spine", "spine_1": "Spine", "spine_2": "Spine1", "chest": "Spine2",
        "neck": "Neck", "head": "Head", "head_end": "HeadTop_End", "collar": "Shoulder", "shoulder": "Arm", "elbow": "ForeArm",
        "wrist": "Hand", "finger": "HandMiddle1", "hand_end": "HandMiddle4", "hip": "UpLeg", "knee": "Leg", "ankle": "Foot",
        "toe": "ToeBase", "foot_end": "Toe_End",
    }),
    "smpl": ("{side}{name}", {
        "pelvis": "pelvis", "torso": "pelvis", "spine": "spine1", "spine_1": "spine1", "spine_2": "spine2", "chest": "spine3",
        "neck": "neck", "head": "head", "collar": "collar", "shoulder": "shoulder", "elbow": "elbow", "wrist": "wrist",
        "finger": "hand", "hip": "hip", "knee": "knee", "ankle": "ankle", "toe": "foot",
    }),
    "openpose": ("{side}{name}", {
        "pelvis": "MidHip", "torso": "MidHip", "neck": "Neck", "head": "Head", "shoulder": "Shoulder", "elbow": "Elbow",
        "wrist": "Wrist", "hip": "Hip", "knee": "Knee", "ankle": "Ankle", "foot_end": "BigToe",
    }),
    "vrm": ("{side}{name}", {
        "pelvis": "hips", "torso": "hips", "spine": "spine", "spine_1": "spine", "spine_2": "chest", "chest": "upperChest",
        "neck": "neck", "head": "head", "collar": "Shoulder", "shoulder": "UpperArm", "elbow": "LowerArm", "wrist": "Hand",
        "finger": "MiddleProximal", "hip": "UpperLeg", "knee": "LowerLeg", "ankle": "Foot", "toe": "Toes",
    }),
    "isb": ("{name}{side}", {
        "pelvis": "pelvis", "torso": "pelvis", "spine": "lumbar", "spine_1": "lumbar", "spine_2": "lumbar_2",
        "chest": "thorax", "neck": "C7", "head": "head", "collar": "SC", "shoulder": "GH", "elbow": "EJC", "wrist": "WJC",
        "hip": "HJC", "knee": "KJC", "ankle": "AJC", "toe": "MTP",
    }),
}  # fmt: skip
"""How side and name are put together, and the names of stations. Mixamo's rig; joints of SMPL (Loper 2015); BODY_25 of OpenPose
(Cao 2019); the humanoid of VRM 1.0; centres of joints as the recommendations of the ISB have them (Wu 2002, 2005)."""
SIDES: Mapping[str, tuple[str, str]] = {
    "mixamo": ("Left", "Right"), "smpl": ("left_", "right_"), "openpose": ("L", "R"), "vrm": ("left", "right"),
    "isb": ("_L", "_R"),
}  # fmt: skip
"""Left and right in each style."""


def styled_names(
    names: Sequence[Named | None],
    given: Sequence[str],
    style: str,
    sides: tuple[str, str],
    rename: Mapping[str, str],
) -> tuple[str, ...]:
    """Unique names of all joints in one spelling.

    names  : (joint,) stations; None where there is none
    given  : (joint,) names of joints without a station
    style  : one of STYLES, or kinetree; a station that the style does not have is spelled as kinetree does
    sides  : what kinetree appends to names of left and right joints
    rename : names to replace, by what they would be or by the given name of the joint
    """
    unique: list[str] = []
    for name, plain in zip(names, given, strict=True):
        text = plain if name is None else _spelled(name, style, sides)
        unique.append(_numbered(rename.get(plain, rename.get(text, text)), unique))
    return tuple(unique)


def names_beside(
    named: Sequence[Named], beside: Sequence[str], style: str, sides: tuple[str, str], rename: Mapping[str, str]
) -> tuple[str, ...]:
    """Names of further joints in the same spelling, other than those that are there; for the rest see `styled_names`.

    beside : names that others have
    """
    unique = list(beside)
    for name in named:
        text = _spelled(name, style, sides)
        unique.append(_numbered(rename.get(text, text), unique))
    return tuple(unique[len(beside) :])


def _numbered(text: str, others: Sequence[str]) -> str:
    """A name with a number behind it where another has it already."""
    numbered, number = text, 2
    while numbered in others:
        numbered, number = f"{text}_{number}", number + 1
    return numbered


def _spelled(name: Named, style: str, sides: tuple[str, str]) -> str:
    """One name in a style."""
    side = "lr".find(name.side) if name.side else -1
    if style == "kinetree" or name.station not in STYLES[style][1]:
        return name.station + (sides[side] if side >= 0 else "")
    form, spelled = STYLES[style]
    return form.format(side=SIDES[style][side] if side >= 0 else "", name=spelled[name.station])
