"""The order in which frames are reached from the reference, and the frames of every pass (ours)."""

from collections.abc import Sequence
from typing import Annotated, ClassVar

from kinetree.schemas.array import Array, Artifact, Index, Ints
from kinetree.schemas.dims import FRAME


class TrackingOrder(Artifact):
    """A tree of frames, whose root is the reference."""

    opens: ClassVar[tuple[str, ...]] = ("pass/frame", "pass/search/frame")
    frames: tuple[int, ...]
    """Source frame number of every frame, ascending."""
    before: Annotated[Ints, Array("int32", FRAME)]
    """Position of the frame from which each frame is reached, −1 for the reference, and for all with fixed connectivity."""

    def members(self, space: str, index: Index) -> Sequence[int]:
        """The frames of a pass, or of its search, which are all."""
        return self.frames

    def previous(self, member: int) -> int | None:
        """The frame from which this one is reached; None for the reference."""
        at = int(self.before[self.frames.index(member)])
        return None if at < 0 else self.frames[at]
