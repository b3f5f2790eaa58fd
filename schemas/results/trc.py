"""The joints as markers in a TRC file, for OpenSim."""

from typing import Literal

from pydantic import Field

from kinetree.schemas.array import Params
from kinetree.schemas.results.exports import PlacedFile


class TrcParams(Params):
    """Orientation and unit of the file."""

    up: Literal["y", "z"] = "y"
    """Axis of the file that points up; OpenSim's is y."""
    scale: float | None = Field(default=None, gt=0)
    """Length in the file of one unit of the input; None: the file is in millimetres."""


class Trc(PlacedFile):
    """skeleton.trc: every joint as a marker; frames that the sequence does not have are empty."""
