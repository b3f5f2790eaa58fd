"""The articulated body as the aligned vertices show it, and the frames that ask for a fit to their surface (2014, Sec. 6.3)."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Annotated, ClassVar

import numpy as np
from pydantic import Field

from kinetree.schemas.array import Array, Bools, Index, Params
from kinetree.schemas.dims import FRAME
from kinetree.schemas.structure.skeleton import Skeleton

TOGETHER = 6
"""Frames in doubt that are fitted together at most."""


class KinematicTreeParams(Params):
    """What counts as a joint."""

    degrees: float = Field(default=6.0, ge=0, le=180)
    """A joint turns by at least this many degrees between some two frames, or its parts are one."""
    ratio: float = Field(default=0.8, ge=0)
    """How far turning moves a joint's smaller part, against how far the joint drifts; below it the part slides, like cloth."""


class KinematicTree(Skeleton):
    """A skeleton whose poses come from aligned vertices alone; each run of frames in doubt opens a member of "doubt"."""

    opens: ClassVar[tuple[str, ...]] = ("doubt", "doubt/frame")
    doubted: Annotated[Bools, Array("bool", FRAME)]
    """Frames in which some part is believed so little that the surface is asked."""

    def runs(self) -> tuple[tuple[int, ...], ...]:
        """Source frames in doubt, neighbours together, a few at a time."""
        at = np.flatnonzero(self.doubted)
        ends = [0, *(i + 1 for i, (a, b) in enumerate(pairwise(at)) if b > a + 1), len(at)]
        rows = [at[k : min(k + TOGETHER, b)] for a, b in pairwise(ends) for k in range(a, b, TOGETHER)]
        return tuple(tuple(self.frames[t] for t in run) for run in rows)

    def members(self, space: str, index: Index) -> Sequence[int]:
        """The runs of frames in doubt, numbered from 0, and the source frames of one."""
        return range(len(self.runs())) if space == "doubt" else self.runs()[index[0]]
