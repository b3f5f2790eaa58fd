"""The sequence as a whole: which frames, how fast, in what unit."""

from pydantic import Field

from kinetree.schemas.array import Artifact, Params
from kinetree.schemas.input.source import BadFrame


class SequenceParams(Params):
    """What the user says of time and unit, where the files do not state it or state it wrongly."""

    fps: float | None = Field(default=None, gt=0)
    """Frames a second; None takes what the files state, or leaves it unknown."""
    unit: str | None = None
    """Unit of the coordinates, e.g. mm; None takes what the files state, or leaves it unknown."""


class Sequence(Artifact):
    """The frames of a run in order, with their numbers in the source."""

    frames: tuple[int, ...]
    """Source frame number of every frame, ascending."""
    fps: float | None
    """Frames a second; None where nobody knows. No step depends on it."""
    unit: str | None
    """Unit of all lengths; None where nobody knows. No step depends on it."""
    dropped: tuple[BadFrame, ...] = ()
    """Frames that were left out because they cannot be of the same body."""
