"""The frames that the report shows: evenly spread, and made coarse alike where they share their faces."""

from results.sample_report import artifacts

from kinetree.schemas.results.excerpt import Excerpt, ExcerptParams
from kinetree.tasks.results.excerpt import excerpt


def of(params: ExcerptParams, anew: bool = False) -> Excerpt:
    content = artifacts(anew=anew)
    return excerpt(sequence=content["sequence"], mesh=content["mesh"], params=params)


def test_first_and_last_frame_are_shown() -> None:
    chosen = of(ExcerptParams(frames=4, views=2))
    assert chosen.frames == (0, 4, 7, 11)
    assert chosen.pictured == (0, 11)


def test_frames_with_the_same_faces_follow_the_first_of_them() -> None:
    chosen = of(ExcerptParams(frames=4))
    assert [chosen.previous(frame) for frame in chosen.frames] == [None, 0, 0, 0]


def test_frames_with_faces_of_their_own_follow_none() -> None:
    chosen = of(ExcerptParams(frames=4), anew=True)
    assert chosen.alike == chosen.frames
    assert not any(chosen.previous(frame) for frame in chosen.frames)


def test_the_frames_shown_are_an_index_of_their_own() -> None:
    chosen = of(ExcerptParams(frames=4))
    assert (chosen.members("shown", ()), chosen.members("shown/frame", (0,))) == ((0,), (0, 4, 7, 11))
