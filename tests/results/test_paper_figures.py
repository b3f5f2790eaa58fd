"""Figures of the 2014 method: its steps as chapters, with and without joints."""

import numpy as np
from mesoscopic import SPANS, made
from results.sample_report import UP, artifacts, page

from kinetree.schemas.results.structure_figures import StructureFigures
from kinetree.schemas.topology.intervals import Intervals
from kinetree.tasks.results.page.chapters import sections
from kinetree.tasks.results.paper_figures import paper_figures


def drawn(*, still: bool = False) -> StructureFigures:
    here = made(still=still)
    steps = np.zeros(SPANS[-1].stop - 1)
    begin, end = (np.array([at(s) for s in SPANS]) for at in (lambda s: s.start, lambda s: s.stop - 1))
    cut = Intervals(
        frames=tuple(range(SPANS[-1].stop)), begin=begin, end=end,
        z=steps, cues=(("leaves",),), strengths=steps[None], cue_names=("leaves",), threshold=2.0,
    )  # fmt: skip
    clusters = tuple(here.annuli[index] for index in sorted(here.annuli))
    whole = (here.consistency, clusters, here.integration, here.cylinders, here.bones, here.skeleton)
    return paper_figures(here.middle, *whole, cut, UP)


def test_cones_and_bones_have_chapters_with_what_was_decided_in_words() -> None:
    told = drawn()
    assert [c.anchor for c in told.chapters] == ["cones", "bones"]
    assert "cone 1 is missing in interval 1; it was recovered from the neighbouring intervals" in told.chapters[0].paragraphs
    assert [len(c.pictures) for c in told.chapters] == [2, 2]
    assert len(told.length_variation) == len(made().skeleton.names)


def test_body_without_joints_has_its_chapters_all_the_same() -> None:
    assert [len(c.pictures) for c in drawn(still=True).chapters] == [2, 2]


def test_chapters_stand_on_any_page() -> None:
    assert artifacts()["structure_figures"] != drawn()
    text = page(sections=sections(drawn()))
    assert text.index('<section id="cones">') < text.index('<section id="bones">')
