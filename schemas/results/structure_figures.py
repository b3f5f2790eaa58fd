"""What a method found its joints by, for people to look at: chapters of a report, whatever the method."""

from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray

from kinetree.schemas.array import Array, Artifact, Floats, Params
from kinetree.schemas.dims import BYTE, JOINT, PICTURE


class Picture(Params):
    """One picture."""

    caption: str
    """What is seen."""
    kind: Literal["png", "svg"]
    """png for surfaces, svg for lines."""


class Chapter(Params):
    """One chapter: words and pictures."""

    anchor: str
    """Name of the place in a page."""
    heading: str
    """What it is called."""
    told: tuple[str, ...] = ()
    """Paragraphs of plain text, after the pictures."""
    pictures: tuple[Picture, ...] = ()
    """In order."""


class StructureFigures(Artifact):
    """The chapters that only this method can write."""

    chapters: tuple[Chapter, ...]
    """In order."""
    varies: Annotated[Floats, Array("float64", JOINT, finite=False)]
    """By what the bone to the parent varies before its length is held, % of its mean; NaN where nobody knows."""
    end: Annotated[NDArray[np.int64], Array("int64", PICTURE)]
    """Where each picture of all chapters, one after another, ends in `content`."""
    content: Annotated[NDArray[np.uint8], Array("uint8", BYTE)]
    """The pictures' files."""

    def shown(self, chapter: Chapter) -> tuple[bytes, ...]:
        """The files of a chapter's pictures."""
        before = sum(len(c.pictures) for c in self.chapters[: self.chapters.index(chapter)])
        begin = [0, *self.end.tolist()]
        at = range(before, before + len(chapter.pictures))
        return tuple(self.content[begin[n] : begin[n + 1]].tobytes() for n in at)
