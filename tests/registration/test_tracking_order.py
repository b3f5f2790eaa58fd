"""Contract of tracking_order: outwards from the reference, by source frame numbers, also for further frames."""

import numpy as np

from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.registration.take_entries import TakeEntries
from kinetree.schemas.registration.tracking_order import TrackingOrder
from kinetree.schemas.topology.extrema import Extrema
from kinetree.schemas.topology.leaves import Leaves
from kinetree.tasks.registration.tracking_order import tracking_order


def ordered(frames: range, at: int, *, learned: range | None = None, fixed: bool = False, still: bool = False) -> TrackingOrder:
    used = tuple(learned or frames)
    reference = Reference(
        frames=used, frame=at, fixed=fixed, leaves=5, free=True, vertices=np.zeros((3, 3)), faces=np.array([[0, 1, 2]]),
        size=1.0, stems=np.zeros((0, 4, 3)), score=np.zeros(len(used)),
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
    seen = {t: arm(0.0 if still else 0.3 * t) for t in used}
    one = np.zeros((1, len(used)), np.int32)
    leaves = Leaves(
        frames=used, rows=one, positions=np.zeros((1, len(used), 3)), kept=np.ones((1, 1), bool),
        lost=one[0, :0], lost_begin=one[0, :0], lost_end=one[0, :0],
    )  # fmt: skip
    sequence = Sequence(frames=tuple(frames), fps=None, unit=None, further=further)
    return tracking_order(reference, none, sequence, seen, leaves)


def arm(at: float) -> Extrema:
    """One limb that stands at a place along x."""
    stem = np.array([[[at, 0.0, z] for z in range(4)]])
    none = np.zeros(0)
    return Extrema(
        vertices=np.zeros(1, np.int32), persistence=np.ones(1), stems=stem, normals=np.eye(3)[2:], value=np.ones(1),
        peaks=none, loops=none, size=1.0, centre=(0.0, 0.0, 0.0), euler=2, components=1,
    )  # fmt: skip


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


def test_a_body_that_stands_still_is_followed_by_long_steps() -> None:
    told = ordered(range(20), 0, still=True)
    assert [told.previous(t) for t in (1, 6, 7, 12, 13)] == [0, 0, 6, 6, 12]


def test_further_frames_are_reached_from_their_neighbours_though_the_body_stands_still() -> None:
    told = ordered(range(10), 0, learned=range(8), still=True)
    assert [told.previous(t) for t in (7, 8, 9)] == [6, 7, 8]
