"""Pictures of the structure that show the names of joints."""

from results.plain_names import plain
from results.rigged_bodies import spider
from results.sample_derivation import parts_of, tree_of
from results.sample_report import UP, derived

from kinetree.schemas.input.sequence import Sequence
from kinetree.tasks.results.named_figures import named_figures


def test_they_are_the_same_files_in_the_chapter_and_show_names() -> None:
    body = spider()
    sequence = Sequence(frames=body.frames, fps=body.fps, unit=body.unit)
    drawn = named_figures(parts_of(body), tree_of(body), plain(body), sequence, UP)
    (chapter,) = derived(body).chapters
    files = derived(body).picture_files(chapter)
    assert [files[k] for k in (1, 4)] == list(drawn.files())
    assert [chapter.pictures[k] for k in (1, 4)] == list(drawn.pictures)
