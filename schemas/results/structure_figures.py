"""Chapters of a report that show how a method found its joints; every method leaves them in this form."""

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from kinetree.schemas.array import Array, Artifact, Floats, Params
from kinetree.schemas.dims import BYTE, JOINT, PICTURE
from kinetree.schemas.results.figures import Picture


class Chapter(Params):
    """One chapter: pictures and paragraphs."""

    anchor: str
    """Identifier of the chapter in the page, for links."""
    heading: str
    """Its heading."""
    paragraphs: tuple[str, ...] = ()
    """Plain text, after the pictures."""
    pictures: tuple[Picture, ...] = ()
    """Its pictures, in order."""


class StructureFigures(Artifact):
    """The chapters of one method, with their pictures."""

    chapters: tuple[Chapter, ...]
    """The chapters, in order."""
    length_variation: Annotated[Floats, Array("float64", JOINT, finite=False)]
    """Standard deviation of the length of the bone to the parent before it is fixed, % of its mean; NaN where not known."""
    end: Annotated[NDArray[np.int64], Array("int64", PICTURE)]
    """Position in `content` at which each picture ends, the pictures of all chapters in order."""
    content: Annotated[NDArray[np.uint8], Array("uint8", BYTE)]
    """The files of all pictures, one after another."""

    def picture_files(self, chapter: Chapter) -> tuple[bytes, ...]:
        """The files of a chapter's pictures, in order."""
        before = sum(len(c.pictures) for c in self.chapters[: self.chapters.index(chapter)])
        begin = [0, *self.end.tolist()]
        at = range(before, before + len(chapter.pictures))
        return tuple(self.content[begin[n] : begin[n + 1]].tobytes() for n in at)
