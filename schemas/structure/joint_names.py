"""Names that people know for the joints of people and four-legged animals, and which way the body faces."""

from typing import Annotated, Any, Literal, get_args

from pydantic import BeforeValidator, Field

from kinetree.schemas.array import Array, Artifact, Floats, Params
from kinetree.schemas.dims import XYZ

Axis = Literal["x", "y", "z", "-x", "-y", "-z"]
Style = Literal["kinetree", "mixamo", "smpl", "openpose", "vrm", "isb", "none"]
STYLES: tuple[str, ...] = get_args(Style)
CERTAIN_FRONT = 0.5
"""Confidence of the front below which a run warns that left and right may be exchanged, and files are not turned by it."""


def _no_file(style: Any) -> Any:
    """The style; raises ValueError where it looks like a file of names, which an export takes."""
    if isinstance(style, str) and style not in STYLES and ("." in style or "/" in style):
        raise ValueError(
            f"a run takes a style: {', '.join(STYLES)}; a file of names is for kinetree export --names FILE, and"
            " joint_names.rename sets single names"
        )
    return style


class JointNamesParams(Params):
    """How joints are named in files and tables; the skeleton itself keeps its own names."""

    style: Annotated[Style, BeforeValidator(_no_file)] = "kinetree"
    """Whose names: kinetree has pelvis, spine, chest, neck, head, shoulder_l …; none keeps root, limb_a_1 and so on."""
    front: Axis | None = None
    """Direction of the coordinates that the body faces in the reference frame; None finds it. Left and right follow from it."""
    side_suffixes: tuple[str, str] = ("_l", "_r")
    """What kinetree's names of left and right joints end in, e.g. [.L, .R]."""
    rename: dict[str, str] = Field(default_factory=dict)
    """Names to replace, e.g. {limb_a_1: jaw}; both the names of this task and those of the skeleton are known."""


class JointNames(Artifact):
    """A name for every joint of the skeleton."""

    given: tuple[str, ...]
    """The skeleton's own names."""
    names: tuple[str, ...]
    """Unique, in the order of the skeleton's joints."""
    anatomy: tuple[str, ...]
    """Station and side of every joint in kinetree's spelling, such as knee_l; empty where none was recognised."""
    topology: Literal["human", "quadruped", "unknown"]
    """What the body was recognised as."""
    confidence: float
    """Of that, 0 to 1."""
    front: Annotated[Floats, Array("float64", XYZ)]
    """Direction that the body faces in the reference frame, horizontal, of length 1; zeros where it is not known."""
    front_confidence: float
    """Of the front, and so of left and right, 0 to 1; 1 where the user says it."""
    spelling: JointNamesParams = JointNamesParams()
    """How the names are spelled, for joints that are added later."""
