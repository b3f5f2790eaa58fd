"""Figures of the 2009 method: its steps as chapters."""

from pathlib import Path
from typing import Any

import pytest
from results.sample_report import UP
from volumetric import volumetric

from kinetree.schemas.input.sequence import Sequence
from kinetree.tasks.results.page.chapters import sections
from kinetree.tasks.results.plots import PLOTS_OF_METHOD, draw
from kinetree.tasks.results.reeb_figures import reeb_figures

SEQUENCE = Sequence(frames=tuple(range(5)), fps=25.0, unit=None)


@pytest.mark.parametrize("letter", [False, True])
def test_graphs_and_clusters_have_chapters_with_what_was_found_in_words(letter: bool) -> None:
    v = volumetric(letter=letter)
    given = (v.integrated_structure, v.coherent_intervals, v.contact_kinds, v.tree, UP, SEQUENCE)
    figures = reeb_figures(*given, v.reeb_graph, v.perg, v.graph_motion, v.mesh)
    assert [(c.anchor, len(c.pictures)) for c in figures.chapters] == [("graphs", 2), ("clusters", 2)]
    assert "frames are topologically coherent, with 3 ends" in figures.chapters[0].paragraphs[0]
    assert [s.anchor for s in sections(figures)] == ["graphs", "clusters"]


@pytest.mark.parametrize("what", ["endoskeleton", "coherence", "clusters", "description"])
def test_every_picture_of_the_method_is_drawn_by_the_command(what: str, tmp_path: Path) -> None:
    here = volumetric()

    def fetch(name: str, frame: int | None = None) -> Any:
        if name == "sequence":
            return SEQUENCE
        return getattr(here, name) if frame is None else getattr(here, name)[frame]

    draw(what, fetch, [0, 4], tmp_path / "a.png", plots=PLOTS_OF_METHOD["reeb"])
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
