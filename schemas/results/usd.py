"""The animated body as a USD file, for film and simulation."""

from typing import Literal

from pydantic import Field

from kinetree.schemas.array import Params
from kinetree.schemas.results.exports import PlacedFile


class UsdParams(Params):
    """How the body is brought upright and to metres."""

    up: Literal["x", "y", "z", "-x", "-y", "-z"] | None = Field(default=None)
    """Axis of the input that points up; None: the one that was found, see up_direction. USD knows y and z, which are stated;
    the body is turned to y for any other."""
    scale: float | None = Field(default=None, gt=0)
    """Metres of one unit of the input; None: as glb.scale."""


class Usd(PlacedFile):
    """skeleton.usda: the reference mesh skinned to the animated skeleton (UsdSkel)."""
