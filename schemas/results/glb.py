"""The body as animators take it: a GLB file."""

from typing import Literal

from pydantic import Field

from kinetree.schemas.array import Params
from kinetree.schemas.results.exports import Exported

ASSUMED_FPS = 30.0
"""Frames a second of an animation whose sequence does not tell."""


class GlbParams(Params):
    """How the body stands in the file."""

    up: Literal["x", "y", "z", "-x", "-y", "-z"] = "y"
    """Axis of the input that points up; glTF's own is y, anything else turns the whole body."""
    scale: float | None = Field(default=None, gt=0)
    """Metres that one unit of the input is: glTF measures in metres; None takes it from the unit, or 1 where nobody knows."""


class Glb(Exported):
    """skeleton.glb: the reference mesh skinned to the animated skeleton (glTF 2.0)."""

    assumed_fps: float | None
    """Frames a second that were assumed since nobody knows; None where the sequence tells."""
    scale: float
    """Metres that one unit of the input was taken for."""
    unit: str | None
    """The input's own unit; None where nobody knows."""
