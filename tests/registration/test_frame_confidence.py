"""Contract of frame_confidence: outliers are marked and named by their numbers."""

from types import SimpleNamespace
from typing import Any

from stepwise import walk

from kinetree.pipeline import views
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.registration.frame_confidence import FrameConfidence
from kinetree.tasks.registration.frame_confidence import frame_confidence


def confidence_of(
    uncovered: list[float], unreliable: list[float] | None = None, first: int = 10, further: tuple[int, ...] = ()
) -> FrameConfidence:
    shares = unreliable or [0.0] * len(uncovered)
    frames: Any = {
        first + t: SimpleNamespace(uncovered=u, unreliable=d, distance=0.01)
        for t, (u, d) in enumerate(zip(uncovered, shares, strict=True))
    }
    mesh: Any = {frame: SimpleNamespace(cleaning=SimpleNamespace(area=4.0)) for frame in frames}
    return frame_confidence(frames, mesh, Sequence(frames=tuple(frames), fps=None, unit=None, further=further))


def test_even_alignment_has_no_outliers_and_says_nothing() -> None:
    made = confidence_of([0.001] * 6)
    assert made.inlier.all()
    assert views.remarks(made) == ()
    assert made.residual.tolist() == [0.005] * 6


def test_frames_that_stand_out_are_told_as_runs() -> None:
    made = confidence_of([0.001, 0.2, 0.3, 0.001, 0.001, 0.2, 0.001, 0.001, 0.001])
    assert made.inlier.tolist() == [True, False, False, True, True, False, True, True, True]
    assert views.remarks(made) == ("alignment failed in frames 11–12, 15: the aligned body does not fit the mesh there",)


def test_limb_that_is_not_seen_is_reported_where_the_frame_is_an_inlier() -> None:
    made = confidence_of([0.001] * 5, unreliable=[0.0, 0.0, 0.12, 0.1, 0.0])
    expected = "alignment partly unreliable in frames 12–13: up to 12% of the body is hidden or does not fit"
    assert views.remarks(made) == (expected,)


def test_aligned_walk_has_no_outliers() -> None:
    assert walk().frame_confidence.inlier.all()
    assert views.remarks(walk().frame_confidence) == ()


def test_further_frames_are_compared_with_those_that_the_body_is_learned_from() -> None:
    shares = [0.001, 0.001, 0.001, 0.03, 0.03, 0.03, 0.03]
    assert confidence_of(shares).inlier.all()
    assert confidence_of(shares, further=(13, 14, 15, 16)).inlier.tolist() == [True] * 3 + [False] * 4
