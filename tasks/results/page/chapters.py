"""Chapters that a method writes on its own evidence, and how they come to stand on the page."""

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING

import numpy as np

from kinetree.schemas.array import Floats
from kinetree.schemas.results.structure_figures import Chapter, Picture, StructureFigures
from kinetree.tasks.results.page.document import Section, embedded, rendered

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Drawn:
    """A figure with what is seen in it; `vector` for lines, not for surfaces."""

    figure: "Figure"
    caption: str
    vector: bool = True


@dataclass(frozen=True)
class Written:
    """A chapter before its figures are files."""

    anchor: str
    heading: str
    drawn: Sequence[Drawn]
    told: Sequence[str] = ()


def evidence_of(chapters: Sequence[Written], varies: Floats) -> StructureFigures:
    """The artifact of some chapters.

    varies : (joint,) see `Evidence`
    """
    files = [rendered(d.figure, vector=d.vector) for chapter in chapters for d in chapter.drawn]
    return StructureFigures(
        chapters=tuple(
            Chapter(
                anchor=c.anchor,
                heading=c.heading,
                told=tuple(c.told),
                pictures=tuple(Picture(caption=d.caption, kind="svg" if d.vector else "png") for d in c.drawn),
            )
            for c in chapters
        ),
        varies=varies,
        end=np.cumsum([len(f) for f in files], dtype=np.int64),
        content=np.frombuffer(b"".join(files), dtype=np.uint8),
    )


def sections(evidence: StructureFigures) -> list[Section]:
    """The chapters as sections of a page."""
    out = []
    for chapter in evidence.chapters:
        shown = zip(evidence.shown(chapter), chapter.pictures, strict=True)
        body = "".join(embedded(content, p.caption, p.kind) for content, p in shown)
        body += "".join(f"<p>{escape(text)}</p>" for text in chapter.told)
        out.append(Section(chapter.anchor, chapter.heading, body))
    return out
