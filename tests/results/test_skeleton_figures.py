"""The picture of the body with its skeleton."""

from results.rigged_bodies import spider
from results.sample_report import UP

from kinetree.schemas.results.excerpt import Excerpt
from kinetree.tasks.results.skeleton_figures import skeleton_figures


def test_picture_is_of_the_frames_that_are_chosen() -> None:
    chosen = [Excerpt(frames=(0,), alike=(0,), pictured=pictured) for pictured in ((0,), (11,), (0,))]
    first, last, again = (skeleton_figures(skeleton=spider(), excerpt=e, up_direction=UP) for e in chosen)
    assert first.files()[0].startswith(b"<?xml")
    assert first != last
    assert first == again
