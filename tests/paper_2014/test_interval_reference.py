"""The reference of one interval, as the task gives it."""

import numpy as np
import pytest
from sheets import CORNERS, Frame, followed, frame

from kinetree.schemas.paper_2014.interval_reference import IntervalReference
from kinetree.tasks.paper_2014.interval_reference import interval_reference


def made(frames: dict[int, Frame], interval: tuple[int, ...], *ends: int) -> IntervalReference:
    intervals, leaves = followed(frames, *ends)
    mine = {t: frames[t] for t in interval}
    return interval_reference(
        {t: f.mesh for t, f in mine.items()},
        {t: f.geodesics for t, f in mine.items()},
        {t: f.coordinates for t, f in mine.items()},
        intervals,
        leaves,
    )


def test_reference_is_the_middle_frame_with_its_leaves_and_their_coordinates() -> None:
    frames = {t: frame(t) for t in range(10, 19)}
    told = made(frames, (14, 15, 16, 17, 18), 3, 8)
    assert (told.frame, told.frames) == (16, (14, 15, 16, 17, 18))
    here = frames[16]
    np.testing.assert_array_equal(told.vertices, here.mesh.vertices)
    assert told.leaf.tolist() == [0, 1, 2]
    assert told.tip.tolist() == here.place[CORNERS].tolist()
    assert (told.distance[np.arange(3), told.tip] == 0).all()
    assert told.size == pytest.approx(np.sqrt(13 * 8))
    np.testing.assert_array_equal(told.trail[:, 0], frames[14].mesh.vertices[frames[14].place[CORNERS]])


def test_frames_are_reached_from_the_middle_outwards() -> None:
    told = made({t: frame(t) for t in (3, 5, 7, 9)}, (3, 5, 7, 9), 3)
    assert [told.previous(t) for t in told.frames] == [5, None, 5, 7]


def test_reference_sees_all_leaves_even_where_the_middle_does_not() -> None:
    frames = {t: frame(t, hidden=(1,) if t in (2, 3) else ()) for t in range(7)}
    told = made(frames, tuple(range(7)), 6)
    assert told.frame == 4
    assert np.isnan(told.trail[1, [2, 3]]).all()


def test_leaves_that_are_seldom_seen_are_none_of_the_interval() -> None:
    frames = {t: frame(t, hidden=(1,)) for t in range(3)}
    told = made(frames, (0, 1, 2), 2)
    assert told.leaf.tolist() == [0, 2]
    bare = made({t: frame(t, hidden=(0, 1, 2)) for t in range(3)}, (0, 1, 2), 2)
    assert bare.distance.shape[0] == 0
