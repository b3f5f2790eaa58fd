"""The body as animators take it: a GLB file."""

from typing import Literal

from pydantic import Field

from kinetree.schemas.array import Params
from kinetree.schemas.exports import Exported

ASSUMED_FPS = 30.0
"""Frames a second of an animation whose sequence does not tell."""


class GlbParams(Params):
    """How the body stands in the file; as long as nothing is said, exactly as in the input."""

    up: Literal["x", "y", "z", "-x", "-y", "-z"] = "y"
    """Axis of the input that points up; glTF's own is y, anything else turns the whole body."""
    scale: float = Field(default=1.0, gt=0)
    """Metres that one unit of the input is, 0.001 for mm: glTF measures in metres."""


class Glb(Exported):
    """skeleton.glb: the reference mesh skinned to the animated skeleton (glTF 2.0)."""

    assumed_fps: float | None
    """Frames a second that were assumed since nobody knows; None where the sequence tells."""
    life_size: float | None
    """The `scale` that would make the body as large as it is; None where it is, and where the unit is not known."""

    def remarks(self) -> tuple[str, ...]:
        """That the pace is a guess and the size not that of life, where it is so."""
        pace = f"nobody says how fast the sequence is: played at {self.assumed_fps} frames a second; set sequence.fps"
        size = f"in the input's own unit, which other programs take for metres; life-size with glb.scale={self.life_size}"
        return (*([] if self.assumed_fps is None else [pace]), *([] if self.life_size is None else [size]))
