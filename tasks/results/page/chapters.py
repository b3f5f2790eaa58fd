"""Chapters that show how a method found its joints: made into an artifact, and laid out on the page."""

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from kinetree.schemas.array import Floats
from kinetree.schemas.results.figures import Figures, Picture
from kinetree.schemas.results.structure_figures import Chapter, StructureFigures
from kinetree.tasks.results.page.document import Section, embedded, rendered

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class CaptionedFigure:
    """A figure, or its file, with its caption, and with what it shows of this run for those who do not see it."""

    figure: "Figure | bytes"
    caption: str
    alternative: str


@dataclass(frozen=True)
class FigureChapter:
    """A chapter whose figures are not rendered to files yet."""

    anchor: str
    heading: str
    figures: Sequence[CaptionedFigure]
    paragraphs: Sequence[str] = ()


def rendered_figures(figures: Sequence[CaptionedFigure]) -> dict[str, Any]:
    """Renders some figures and returns the fields of `Figures`."""
    files = [_file(d) for d in figures]
    return {
        "pictures": tuple(Picture(caption=d.caption, alternative=d.alternative) for d in figures),
        "end": np.cumsum([len(f) for f in files], dtype=np.int64),
        "content": np.frombuffer(b"".join(files), dtype=np.uint8),
    }


def drawn_before(figures: Figures) -> list[CaptionedFigure]:
    """Figures that another task has rendered."""
    rows = zip(figures.files(), figures.pictures, strict=True)
    return [CaptionedFigure(file, p.caption, p.alternative) for file, p in rows]


def pictures(figures: Figures) -> str:
    """The pictures as HTML that contains their files."""
    return "".join(
        embedded(content, p.caption, p.alternative) for content, p in zip(figures.files(), figures.pictures, strict=True)
    )


def rendered_chapters(chapters: Sequence[FigureChapter], length_variation: Floats) -> StructureFigures:
    """Renders the figures of some chapters and returns them as an artifact.

    length_variation : (joint,) %, see `StructureFigures`
    """
    files = [_file(d) for chapter in chapters for d in chapter.figures]
    return StructureFigures(
        chapters=tuple(
            Chapter(
                anchor=c.anchor,
                heading=c.heading,
                paragraphs=tuple(c.paragraphs),
                pictures=tuple(Picture(caption=d.caption, alternative=d.alternative) for d in c.figures),
            )
            for c in chapters
        ),
        length_variation=length_variation,
        end=np.cumsum([len(f) for f in files], dtype=np.int64),
        content=np.frombuffer(b"".join(files), dtype=np.uint8),
    )


def sections(figures: StructureFigures) -> list[Section]:
    """The chapters as sections of a page."""
    laid_out = []
    for chapter in figures.chapters:
        rows = zip(figures.picture_files(chapter), chapter.pictures, strict=True)
        body = "".join(embedded(content, p.caption, p.alternative) for content, p in rows)
        body += "".join(f"<p>{escape(text)}</p>" for text in chapter.paragraphs)
        laid_out.append(Section(chapter.anchor, chapter.heading, body, is_detail=True))
    return laid_out


def _file(drawn: CaptionedFigure) -> bytes:
    """The file of a figure."""
    return drawn.figure if isinstance(drawn.figure, bytes) else rendered(drawn.figure)
