"""Frames in which the body may have lost a limb, and from where they are tried again (ours)."""

from typing import Annotated

from kinetree.schemas.array import Array, Artifact, Bools, Floats, Ints
from kinetree.schemas.dims import FRAME


class TrackingFailures(Artifact):
    """Which frames are tried again, and the order: inwards, from beyond a run of suspects back towards the reference."""

    frames: tuple[int, ...]
    """Source frame number of every frame, ascending."""
    uncovered: Annotated[Floats, Array("float64", FRAME)]
    """Share of each frame's surface that the tracked body does not explain."""
    suspect: Annotated[Bools, Array("bool", FRAME)]
    """Frames that leave clearly more uncovered than the others."""
    usual: float
    """The least that any frame but the reference left uncovered."""
    after: Annotated[Ints, Array("int32", FRAME)]
    """Position of the frame from whose pose each suspect is tried again, −1 where there is none or no need."""

    def previous(self, member: int) -> int | None:
        """The next frame away from the reference; None for frames that are not suspect and for the last of a sequence."""
        at = int(self.after[self.frames.index(member)])
        return None if at < 0 else self.frames[at]
