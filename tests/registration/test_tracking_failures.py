"""Contract of suspects: frames that stand out, and the way inwards from beyond them."""

from types import SimpleNamespace
from typing import Any

import numpy as np

from kinetree.schemas.registration.tracking_failures import TrackingFailures
from kinetree.tasks.registration.tracking_failures import tracking_failures


def told(share: list[float], start: int, first: int = 0) -> TrackingFailures:
    tracking: Any = {first + t: SimpleNamespace(uncovered=u) for t, u in enumerate(share)}
    reference: Any = SimpleNamespace(frame=first + start)
    return tracking_failures(tracking, reference)


def test_frames_that_stand_out_are_reached_from_beyond_back_towards_the_reference() -> None:
    found = told([0.001, 0.001, 0.09, 0.001, 0.0, 0.001, 0.08, 0.07, 0.001, 0.001], start=4, first=10)
    assert np.flatnonzero(found.suspect).tolist() == [2, 6, 7]
    assert {t: found.previous(t) for t in found.frames if found.previous(t) is not None} == {12: 11, 16: 17, 17: 18}


def test_suspect_at_the_end_of_a_sequence_has_nothing_beyond() -> None:
    found = told([0.09, 0.001, 0.0, 0.001, 0.001, 0.08], start=2)
    assert np.flatnonzero(found.suspect).tolist() == [0, 5]
    assert all(found.previous(t) is None for t in found.frames)


def test_even_sequence_has_no_suspect_whatever_its_holes_leave_uncovered() -> None:
    found = told([0.05, 0.05, 0.0, 0.051, 0.05], start=2)
    assert not found.suspect.any()
    assert found.usual == 0.05


def test_reference_is_never_suspect() -> None:
    assert not told([0.0, 0.9, 0.0, 0.0, 0.0], start=1).suspect.any()


def test_reference_alone_and_one_more_frame_are_no_suspects() -> None:
    assert not told([0.0], start=0).suspect.any()
    assert not told([0.0, 0.001], start=0).suspect.any()
