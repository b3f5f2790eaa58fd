"""The animated body as a GLB file, for animators."""

from typing import Literal

from pydantic import Field

from kinetree.schemas.array import Params
from kinetree.schemas.results.exports import PlacedFile

ASSUMED_FPS = 30.0
"""Frames a second of an animation where the sequence has no frame rate."""


RestChoice = Literal["reference", "t", "a"]


class GlbParams(Params):
    """Orientation and size of the body in the file."""

    up: Literal["x", "y", "z", "-x", "-y", "-z"] | None = Field(default=None)
    """Axis of the input that points up, which becomes glTF's +y; None: the one that was found, see up_direction."""
    scale: float | None = Field(default=None, gt=0)
    """Metres of one unit of the input, as glTF is in metres; None: from the sequence's unit; where that is not known,
    guessed from the size of the body: m, cm or mm."""
    rest: RestChoice = "reference"
    """Rest pose: the body as it is in the reference frame, or a person in a T-pose or an A-pose."""
    surface: Literal["input", "parts"] = "input"
    """Textures and colours of the input, where it has them, or the colours of the parts."""


class Glb(PlacedFile):
    """skeleton.glb: the reference mesh skinned to the animated skeleton (glTF 2.0)."""

    rest: RestChoice
    """Rest pose of the file; only a person has others than that of the reference."""
    missing: tuple[str, ...] = ()
    """Sentences on textures that could not be had."""
