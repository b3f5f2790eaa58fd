"""The sequence as a whole: which frames, how fast, in what unit, and which frames decide about the others."""

import collections.abc as abc
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field

from kinetree.schemas.array import Artifact, Index, Params
from kinetree.schemas.input.source import BadFrame

UNIT_WORDS = {
    "mm": ("millimetre", "millimetres", "millimeter", "millimeters"),
    "cm": ("centimetre", "centimetres", "centimeter", "centimeters"),
    "dm": ("decimetre", "decimetres", "decimeter", "decimeters"),
    "m": ("metre", "metres", "meter", "meters"),
    "km": ("kilometre", "kilometres", "kilometer", "kilometers"),
    "in": ("inch", "inches"),
    "ft": ("foot", "feet"),
}
"""What people call each unit of length."""


def _abbreviated(unit: Any) -> Any:
    """The unit in short, of any word for it in any case; what is none stays as it is."""
    word = unit.lower() if isinstance(unit, str) else unit
    return next((short for short, words in UNIT_WORDS.items() if word == short or word in words), unit)


Unit = Annotated[Literal["mm", "cm", "dm", "m", "km", "in", "ft"], BeforeValidator(_abbreviated)]
"""A unit of length whose length is known."""


class SequenceParams(Params):
    """What the user says of time and unit, where the files do not state it or state it wrongly."""

    fps: float | None = Field(default=None, gt=0)
    """Frames a second; None takes what the files state, or leaves it unknown."""
    unit: Unit | None = None
    """Unit of the coordinates: mm, cm, dm, m, km, in or ft; None takes what the files state, or leaves it unknown."""
    learn_from: str = ":"
    """Frames from which the body is learned, as start:stop:step; the others are posed and change no other frame."""


class Sequence(Artifact):
    """The frames of a run in order, with their numbers in the source.

    It selects the frames from which the body is learned: what concerns all frames, such as the reference, the stiffness or the
    rigid parts, is made of these alone. Each other frame opens a member of "further".
    """

    opens: ClassVar[tuple[str, ...]] = ("further", "further/frame")
    selects: ClassVar[str] = "frame"
    frames: tuple[int, ...]
    """Source frame number of every frame, ascending."""
    fps: float | None
    """Frames a second; None where nobody knows. No step depends on it."""
    unit: str | None
    """Unit of all lengths; None where nobody knows. No step depends on it."""
    dropped: tuple[BadFrame, ...] = ()
    """Frames that were left out because they cannot be of the same body."""
    takes: tuple[str, ...] = ()
    """Names of the takes, in their order; none where there is one alone. Frame t of take k has the number k · 10⁹ + t."""
    further: tuple[int, ...] = ()
    """Frames that nothing is learned from, ascending; they are posed as the others taught."""

    @property
    def learned(self) -> tuple[int, ...]:
        """Source frame numbers of the frames from which the body is learned, ascending."""
        further = frozenset(self.further)
        return tuple(t for t in self.frames if t not in further)

    def selected(self) -> abc.Sequence[int]:
        """The frames from which the body is learned."""
        return self.learned

    def members(self, space: str, index: Index) -> abc.Sequence[int]:
        """The further frames; each holds itself."""
        return self.further if space == "further" else index
