"""The joints as markers in a C3D file, for motion analysis."""

from typing import Literal

from pydantic import Field

from kinetree.schemas.array import Params
from kinetree.schemas.results.exports import PlacedFile


class C3dParams(Params):
    """Orientation and unit of the file."""

    up: Literal["y", "z"] = "z"
    """Axis of the file that points up; laboratories use z."""
    scale: float | None = Field(default=None, gt=0)
    """Length in the file of one unit of the input; None: the file is in millimetres."""


class C3d(PlacedFile):
    """skeleton.c3d: every joint as a marker; frames that the sequence does not have are marked as missing."""
