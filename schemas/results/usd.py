"""The animated body as a USD file, for film and simulation."""

from typing import Literal

from kinetree.schemas.array import Params
from kinetree.schemas.results.exports import Exported


class UsdParams(Params):
    """How the file describes the input's coordinates, which are not changed."""

    up: Literal["y", "z"] = "y"
    """Axis of the input that points up; USD allows these two."""


class Usd(Exported):
    """skeleton.usda: the reference mesh skinned to the animated skeleton (UsdSkel)."""
