"""The motion as a BVH file, for motion-capture programs."""

from typing import Literal

from pydantic import Field

from kinetree.schemas.array import Params
from kinetree.schemas.results.exports import PlacedFile
from kinetree.schemas.results.glb import RestChoice


class BvhParams(Params):
    """Orientation and unit of the file."""

    up: Literal["y", "z"] = "y"
    """Axis of the file that points up; most programs expect y."""
    scale: float | None = Field(default=None, gt=0)
    """Length in the file of one unit of the input; None: the file is in centimetres."""
    rest: RestChoice = "reference"
    """Pose in which all angles are 0: as the body is in the reference frame, or a person in a T-pose or an A-pose."""


class Bvh(PlacedFile):
    """skeleton.bvh: the joint tree with constant offsets, and its rotations in every frame."""

    rest: RestChoice
    """Pose in which all angles are 0; only a person has others than that of the reference."""
    between: int
    """Number of interpolated frames: BVH has one frame time, so missing frames are interpolated."""
