"""The animated body as a GLB file, for animators."""

from typing import Literal

from pydantic import Field

from kinetree.schemas.array import Params
from kinetree.schemas.results.exports import Exported

ASSUMED_FPS = 30.0
"""Frames a second of an animation where the sequence has no frame rate."""


class GlbParams(Params):
    """Orientation and size of the body in the file."""

    up: Literal["x", "y", "z", "-x", "-y", "-z"] = "y"
    """Axis of the input that points up; glTF's is y, so the whole body is rotated for any other."""
    scale: float | None = Field(default=None, gt=0)
    """Metres of one unit of the input, as glTF is in metres; None: from the sequence's unit, or 1 where it is not known."""


class Glb(Exported):
    """skeleton.glb: the reference mesh skinned to the animated skeleton (glTF 2.0)."""

    assumed_fps: float | None
    """Assumed frames a second; None where the sequence has a frame rate."""
    scale: float
    """Metres of one unit of the input in the file."""
    unit: str | None
    """Where the scale is from: the sequence's unit, or glb.scale; None where it is assumed."""
