"""What of a sequence the report shows: which frames play, which stand in pictures, and which of them share their faces."""

from typing import ClassVar

from pydantic import Field

from kinetree.schemas.array import Artifact, Index, Params


class ExcerptParams(Params):
    """How much of a sequence the report shows."""

    frames: int = Field(default=90, ge=1, le=1000)
    """Most frames that the player shows; with more the page opens slowly."""
    views: int = Field(default=4, ge=1, le=12)
    """Number of frames in pictures of the body."""


class Excerpt(Artifact):
    """The frames of a sequence that the report shows."""

    opens: ClassVar[tuple[str, ...]] = ("shown", "shown/frame")
    orders: ClassVar[str] = "frame"

    frames: tuple[int, ...]
    """Source frame number of every frame that the player shows, ascending."""
    alike: tuple[int, ...]
    """For each of these, the first of the frames up to it that all have its faces: they are made coarse alike."""
    pictured: tuple[int, ...]
    """Source frame numbers of the frames in pictures of the body."""

    def members(self, space: str, index: Index) -> tuple[int, ...]:
        """The one member that has all frames shown, or these frames."""
        return (0,) if space == "shown" else self.frames

    def previous(self, member: int) -> int | None:
        """The frame whose coarse mesh this one takes over; None where it has its own."""
        first = self.alike[self.frames.index(member)]
        return None if first == member else first
