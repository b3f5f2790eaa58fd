"""Frames in which tracking failed or exchanged limbs, and the poses that replace theirs (ours)."""

from typing import Annotated

import numpy as np

from kinetree.schemas.array import Array, Artifact, Bools, Floats, Ints
from kinetree.schemas.dims import FRAME, NODE, RECOVERED, ROW, XYZ


class Recovery(Artifact):
    """Frames that leave clearly more uncovered than the others, or bend the body more than alike ones do, tracked again."""

    frames: tuple[int, ...]
    """Source frame number of every frame that the body is learned from, ascending."""
    uncovered: Annotated[Floats, Array("float64", FRAME)]
    """Share of each frame's surface that the tracked body does not explain."""
    failed: Annotated[Bools, Array("bool", FRAME)]
    """Frames in which tracking failed: they leave clearly more uncovered than the others."""
    usual: float
    """Smallest share that any frame but the reference leaves uncovered: holes of the capture, which no pose covers."""
    recovered: Annotated[Ints, Array("int32", RECOVERED)]
    """Positions of the frames that have another pose now, which covers more, or as much and bends the body clearly less."""
    uncovered_after: Annotated[Floats, Array("float64", RECOVERED)]
    """Share of each recovered frame that its new pose leaves uncovered."""
    rotation: Annotated[Floats, Array("float64", RECOVERED, NODE, ROW, XYZ)]
    """Rotation of every node in each recovered frame."""
    translation: Annotated[Floats, Array("float64", RECOVERED, NODE, XYZ, unit="length")]
    """Position of every node in each recovered frame."""

    def row(self, frame: int) -> int | None:
        """The row of a source frame among the recovered ones; None for a frame whose tracked pose stays."""
        if frame not in self.frames:
            return None
        at = np.flatnonzero(self.recovered == self.frames.index(frame))
        return int(at[0]) if len(at) else None
