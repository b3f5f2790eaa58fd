"""Contract of tracking_order: outwards from the reference, by source frame numbers, also for further frames."""

import numpy as np

from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.registration.take_entries import TakeEntries
from kinetree.schemas.registration.tracking_order import TrackingOrder
from kinetree.tasks.registration.tracking_order import tracking_order


def ordered(frames: range, at: int, *, learned: range | None = None, fixed: bool = False) -> TrackingOrder:
    used = tuple(learned or frames)
    reference = Reference(
        frames=used, frame=at, fixed=fixed, leaves=5, free=True, vertices=np.zeros((3, 3)), faces=np.array([[0, 1, 2]]),
        size=1.0, score=np.zeros(len(used)),
    )  # fmt: skip
    further = tuple(t for t in frames if t not in used)
    none = TakeEntries(
        frames=(),
        before=(),
        entry=np.zeros(0, np.int32),
        rotation=np.zeros((0, 3, 3)),
        shift=np.zeros((0, 3)),
        distance=np.zeros(0),
    )
    return tracking_order(reference, none, Sequence(frames=tuple(frames), fps=None, unit=None, further=further))


def test_frames_are_reached_outwards_in_both_directions() -> None:
    told = ordered(range(3, 8), 5)
    assert [told.previous(t) for t in range(3, 8)] == [4, 5, None, 5, 6]


def test_appended_frames_hang_on_to_the_order_that_was_there() -> None:
    before, after = ordered(range(3, 8), 5), ordered(range(3, 11), 5, learned=range(3, 8))
    assert [after.previous(t) for t in before.frames] == [before.previous(t) for t in before.frames]
    assert [after.previous(t) for t in (8, 9, 10)] == [7, 8, 9]
    assert after.members("pass/frame", (0,)) == tuple(range(3, 11))


def test_one_or_two_frames_have_an_order() -> None:
    assert ordered(range(1), 0).previous(0) is None
    assert [ordered(range(2), 1).previous(t) for t in (0, 1)] == [1, None]


def test_with_fixed_connectivity_no_frame_needs_another() -> None:
    assert [ordered(range(4), 2, fixed=True).previous(t) for t in range(4)] == [None] * 4
