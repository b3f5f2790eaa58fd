"""Which way is up: files do not say it; pictures and files for other programs need it."""

from typing import Literal

from pydantic import Field

from kinetree.schemas.array import Artifact, Params


class UpDirectionParams(Params):
    """What the user knows of the up direction."""

    up: Literal["x", "y", "z", "-x", "-y", "-z"] | None = Field(default=None)
    """Direction of the coordinates that points up, e.g. z or -y; None finds it. Pictures and files for other programs depend on
    it, and whether a body is taken for a person's, whose spine is placed and whose joints are named."""


class UpDirection(Artifact):
    """The direction of the coordinates that points up in pictures and in files for other programs."""

    up: Literal["x", "y", "z", "-x", "-y", "-z"]
    """The axis, with a minus where it points down."""
    confidence: float
    """By what share no other direction fits as well, 0 to 1; 1 where the user says it."""

    @property
    def axis(self) -> int:
        """0, 1, 2 for x, y, z, and ~0, ~1, ~2 for the opposite directions."""
        at = "xyz".index(self.up[-1])
        return ~at if self.up.startswith("-") else at
