"""The graph of parts: drawn as soon as the tree is there."""

from results.rigged_bodies import spider
from results.sample_derivation import tree_of
from results.sample_report import UP, derived

from kinetree.schemas.input.sequence import Sequence
from kinetree.tasks.methods import METHODS
from kinetree.tasks.results.derivation_figures import derivation_figures


def test_it_is_the_same_file_in_the_chapter() -> None:
    body = spider()
    sequence = Sequence(frames=body.frames, fps=body.fps, unit=body.unit)
    first = derivation_figures(tree_of(body), sequence, UP)
    (chapter,) = derived(body).chapters
    files = derived(body).picture_files(chapter)
    assert (files[3],) == first.files()
    assert (chapter.pictures[3],) == first.pictures


def test_it_waits_for_no_pose_and_no_name() -> None:
    graph = METHODS["mesoscopic"].until(["derivation_figures"])
    assert not {"skeleton", "pose_refinement", "joint_names"} & set(graph.by_name)
