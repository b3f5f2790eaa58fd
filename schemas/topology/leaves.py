"""The leaves of the body: extrema followed through the sequence, a fixed set per interval (2014, Sec. 5.1, Eq. 3)."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from kinetree.schemas.array import Array, Artifact, Bools, Floats, Ints, Params
from kinetree.schemas.dims import FRAME, GAP, INTERVAL, LEAF, XYZ


class LeavesParams(Params):
    """How extrema are followed."""

    method: Literal["stems", "nearest"] = "stems"
    """stems: whole limbs, assigned together, across intervals; nearest: Eq. 3, the nearest in each interval."""
    gate: float = Field(default=0.3, gt=0)
    """Distance between limbs in two frames beyond which they are not the same, share of the root of the area."""
    likeness: float = Field(default=0.2, gt=0)
    """Largest change of log μ at a leaf from one frame in which it is seen to the next."""
    margin: float = Field(default=1.5, ge=1)
    """A lost leaf is taken up again only where every other candidate is so many times farther."""
    share: float = Field(default=0.5, gt=0, le=1)
    """Share of an interval's frames in which a leaf must be seen to be one of the interval's; the paper has 1."""
    bridge: int = Field(default=3, ge=0)
    """Longest gap in frames that is bridged on a straight line."""


class Leaves(Artifact):
    """Every leaf that was followed: where it was, when it was seen, in which intervals it counts, when it was lost."""

    frames: tuple[int, ...]
    """Source frame number of every frame in which leaves were followed, ascending."""
    rows: Annotated[Ints, Array("int32", LEAF, FRAME)]
    """Which of the frame's extrema it is, −1 where it is not seen."""
    positions: Annotated[Floats, Array("float64", LEAF, FRAME, XYZ, unit="length", finite=False)]
    """Where it is; on a straight line through short gaps, NaN where nothing is known."""
    kept: Annotated[Bools, Array("bool", INTERVAL, LEAF)]
    """Which leaves are the fixed set of which interval; one leaf in two intervals is one limb."""
    lost: Annotated[Ints, Array("int32", GAP)]
    """The leaf of each gap, by leaf and then by frame."""
    lost_begin: Annotated[Ints, Array("int32", GAP)]
    """Position of the first frame without it."""
    lost_end: Annotated[Ints, Array("int32", GAP)]
    """Position of the last frame without it, included."""

    def at(self, frame: int) -> Floats:
        """(leaf, xyz) where the leaves are in a source frame; NaN in a frame in which none were followed."""
        known: Floats = self.positions[:, self.frames.index(frame)] if frame in self.frames else self.positions[:, 0] * np.nan
        return known

    def is_seen(self, frame: int) -> Bools:
        """(leaf,) whether each leaf is seen in a source frame."""
        is_seen: Bools = self.rows[:, self.frames.index(frame)] >= 0 if frame in self.frames else self.rows[:, 0] < -1
        return is_seen
