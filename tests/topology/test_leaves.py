"""Leaves followed through a sequence, as the task gives them."""

import numpy as np
import pytest

from kinetree.schemas.topology.extrema import Extrema
from kinetree.schemas.topology.intervals import Intervals
from kinetree.schemas.topology.leaves import Leaves, LeavesParams
from kinetree.tasks.topology.leaves import leaves

FRAMES = 12


def tips_at(*points: tuple[float, float, float]) -> Extrema:
    X = np.array(points, float).reshape(-1, 3)
    stems = np.linspace(0.2, 1.0, 5)[None, :, None] * X[:, None, :]
    up = np.tile([0.0, 0.0, 1.0], (len(X), 1))
    return Extrema(
        vertices=np.arange(len(X)), persistence=np.full(len(X), 0.5), stems=stems, normals=up, value=np.full(len(X), 0.7),
        peaks=np.full(len(X), 0.5), loops=np.zeros(0), size=1.0, centre=(0.0, 0.0, 0.0), euler=2, components=1,
    )  # fmt: skip


def cut(*ends: int) -> Intervals:
    begin = [0, *(e + 1 for e in ends[:-1])]
    return Intervals(
        frames=tuple(range(FRAMES)), begin=np.array(begin), end=np.array(ends), z=np.zeros(FRAMES - 1),
        cues=(("leaves",),) * (len(ends) - 1), strengths=np.zeros((1, FRAMES - 1)), cue_names=("leaves",), threshold=2.0,
    )  # fmt: skip


LEFT, RIGHT = (-1.0, 0.0, 0.0), (1.0, 0.0, 0.0)


def test_leaf_lost_at_a_contact_comes_back_as_itself_and_counts_where_it_was_seen() -> None:
    tips = {n: tips_at(LEFT, RIGHT) if not 4 <= n <= 7 else tips_at(RIGHT) for n in range(FRAMES)}
    followed = leaves(tips, cut(3, 7, 11), LeavesParams())
    assert followed.rows.shape == (2, FRAMES)
    assert followed.kept.tolist() == [[True, True], [False, True], [True, True]]
    assert (followed.lost.tolist(), followed.lost_begin.tolist(), followed.lost_end.tolist()) == ([0], [4], [7])
    assert np.isnan(followed.positions[0, 4:8]).all()


def test_short_gap_is_bridged_on_a_straight_line() -> None:
    tips = {n: tips_at((n / 20, 0.5, 0.0), RIGHT) if n != 5 else tips_at(RIGHT) for n in range(FRAMES)}
    followed = leaves(tips, cut(11), LeavesParams())
    assert followed.positions[0, 5] == pytest.approx([0.25, 0.5, 0.0])
    assert followed.rows[0, 5] == -1


def test_paper_follows_each_interval_by_itself_from_its_first_frame() -> None:
    tips = {n: tips_at(LEFT, RIGHT) if n != 2 else tips_at(LEFT) for n in range(FRAMES)}
    followed = leaves(tips, cut(5, 11), LeavesParams(method="nearest", share=1.0, bridge=0))
    assert followed.rows.shape == (4, FRAMES)
    assert followed.kept.tolist() == [[True, False, False, False], [False, False, True, True]]


def test_body_without_tips_has_no_leaves() -> None:
    followed: Leaves = leaves({n: tips_at() for n in range(FRAMES)}, cut(11), LeavesParams())
    assert followed.rows.shape == (0, FRAMES)
    assert followed.kept.shape == (1, 0)
    literal = leaves({n: tips_at() for n in range(FRAMES)}, cut(11), LeavesParams(method="nearest"))
    assert literal.rows.shape == (0, FRAMES)


def test_in_a_frame_in_which_none_were_followed_no_leaf_is_known() -> None:
    followed = leaves({t: tips_at((0, 0, 1), (0, 1, 0)) for t in (3, 4, 5)}, cut(2), LeavesParams())
    assert (followed.at(4) == followed.positions[:, 1]).all()
    assert followed.is_seen(4).tolist() == [True, True]
    assert np.isnan(followed.at(6)).all()
    assert followed.is_seen(6).tolist() == [False, False]
