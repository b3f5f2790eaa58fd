"""Pictures of the cut: drawn as soon as the parts are there."""

from results.rigged_bodies import spider
from results.sample_derivation import parts_of, reference_of
from results.sample_report import UP, derived

from kinetree.tasks.methods import METHODS
from kinetree.tasks.results.cut_figures import cut_figures


def test_they_are_the_same_files_in_the_chapter() -> None:
    body = spider()
    first = cut_figures(reference_of(body), parts_of(body), UP)
    (chapter,) = derived(body).chapters
    files = derived(body).picture_files(chapter)
    assert [files[k] for k in (0, 2)] == list(first.files())
    assert [chapter.pictures[k] for k in (0, 2)] == list(first.pictures)


def test_they_wait_for_no_tree() -> None:
    assert "kinematic_tree" not in METHODS["mesoscopic"].until(["cut_figures"]).by_name
