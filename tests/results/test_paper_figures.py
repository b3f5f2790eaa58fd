"""Figures of the 2014 method: its steps as chapters, with and without joints."""

import numpy as np
from mesoscopic import SPANS, mesoscopic
from results.sample_report import UP, artifacts, page

from kinetree.schemas.results.structure_figures import StructureFigures
from kinetree.schemas.topology.intervals import Intervals
from kinetree.tasks.results.page.chapters import sections
from kinetree.tasks.results.paper_figures import paper_figures


def figures(*, at_rest: bool = False) -> StructureFigures:
    here = mesoscopic(at_rest=at_rest)
    steps = np.zeros(SPANS[-1].stop - 1)
    begin, end = (np.array([at(s) for s in SPANS]) for at in (lambda s: s.start, lambda s: s.stop - 1))
    cut = Intervals(
        frames=tuple(range(SPANS[-1].stop)), begin=begin, end=end,
        z=steps, cues=(("leaves",),), strengths=steps[None], cue_names=("leaves",), threshold=2.0,
    )  # fmt: skip
    clusters = tuple(here.annuli[index] for index in sorted(here.annuli))
    artifacts_2014 = (here.cone_consistency, clusters, here.integration, here.cylinders, here.bones, here.skeleton)
    return paper_figures(here.interval_references, *artifacts_2014, cut, UP)


def test_cones_and_bones_have_chapters_with_what_was_decided_in_words() -> None:
    here = figures()
    assert [c.anchor for c in here.chapters] == ["cones", "bones"]
    assert "cone 1 is missing in interval 1; it was recovered from the neighbouring intervals" in here.chapters[0].paragraphs
    assert [len(c.pictures) for c in here.chapters] == [2, 2]
    assert len(here.length_variation) == len(mesoscopic().skeleton.names)


def test_body_without_joints_has_its_chapters_all_the_same() -> None:
    assert [len(c.pictures) for c in figures(at_rest=True).chapters] == [2, 2]


def test_chapters_stand_on_any_page() -> None:
    assert artifacts()["structure_figures"] != figures()
    text = page(sections=sections(figures()))
    assert text.index('<section id="cones">') < text.index('<section id="bones">')
