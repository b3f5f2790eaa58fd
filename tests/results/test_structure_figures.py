"""Figures of the structure: chapters whose pictures are complete files."""

import numpy as np
from results.rigged_bodies import spider
from results.sample_report import UP
from traced import traces_of

from kinetree.tasks.results.structure_figures import structure_figures


def test_every_picture_is_a_file_of_its_kind_and_variation_is_that_of_the_traces() -> None:
    body = spider()
    figures = structure_figures(body, traces_of(body), UP)
    begins = {"png": b"\x89PNG", "svg": b"<?xml"}
    for chapter in figures.chapters:
        files = figures.picture_files(chapter)
        assert len(files) == len(chapter.pictures) > 0
        assert all(f.startswith(begins[p.kind]) for f, p in zip(files, chapter.pictures, strict=True))
    assert figures.end[-1] == len(figures.content)
    np.testing.assert_array_equal(figures.length_variation, traces_of(body).variation)


def test_same_traces_are_the_same_bytes() -> None:
    body = spider()
    assert structure_figures(body, traces_of(body), UP) == structure_figures(body, traces_of(body), UP)
