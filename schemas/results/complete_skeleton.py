"""The skeleton with poses between measured frames where frames are missing (ours)."""

from typing import Literal

from pydantic import Field

from kinetree.schemas.array import Params
from kinetree.schemas.structure.skeleton import Skeleton


class CompleteSkeletonParams(Params):
    """Which missing frames have a pose in files."""

    longest: int = Field(default=10, ge=0)
    """Missing frames in a row that are interpolated, at most; a longer gap stays open. 0 interpolates none."""


class Interpolated(Params):
    """A frame without a surface, whose pose lies between those of the frames around it."""

    frame: int
    """Its source frame number."""
    cause: Literal["dropped", "missing"]
    """dropped: its file cannot be used; missing: no file has its number."""
    reason: str = ""
    """Why its file cannot be used."""


class CompleteSkeleton(Skeleton):
    """The skeleton as files have it: measured frames as they are, and interpolated ones among them."""

    interpolated: tuple[Interpolated, ...]
    """The frames that were not measured, ascending."""
    takes: tuple[str, ...] = ()
    """Names of the takes, in their order; none where there is one alone."""
