"""The body as film and simulation programs take it: a USD file."""

from typing import Literal

from kinetree.schemas.array import Params
from kinetree.schemas.results.exports import Exported


class UsdParams(Params):
    """What the file says of the input's coordinates, which stay as they are."""

    up: Literal["y", "z"] = "y"
    """Axis of the input that points up; USD knows these two."""


class Usd(Exported):
    """skeleton.usda: the reference mesh skinned to the animated skeleton (UsdSkel)."""
