"""Which cut gives the tree."""

from typing import NamedTuple, cast

import numpy as np
import pytest
from articulated import Known, chain, cut_by_height, swings

from kinetree.tasks.numerics.structure.agreeing_cut import agreeing_cut, in_other_cuts
from kinetree.tasks.numerics.structure.first_tree import FirstTree, in_tree_order
from kinetree.tasks.numerics.structure.joint_consensus import GATE

FRAMES = 16


def body() -> Known:
    return chain((-2.0, 2.0), swings(FRAMES, 3, seed=1))


def tree_at(*heights: float) -> FirstTree:
    """The tree of a cut at these heights; true joints are at −2 and 2."""
    return in_tree_order(cut_by_height(body(), heights), len(heights) + 1)


def size() -> float:
    return float(np.sqrt(body().area.sum()))


@pytest.mark.parametrize(
    ("cuts", "which"),
    [
        (((-2.0, 2.0), (-2.0, 2.0), (-2.0, 2.0)), 0),
        (((-2.0, 0.0, 2.0), (-2.0, 2.0), (-2.0, 2.0)), 1),
        (((-2.0, 0.0, 2.0), (2.0,), (-2.0, 2.0)), 2),
        (((-2.0,), (-2.0, 0.0, 2.0), (-2.0, 2.0)), 2),
        (((-2.0,), (-2.0, 0.0, 2.0), (-2.0, 0.0, 2.0)), 1),
        (((-2.0, 0.0, 2.0), (-2.0, 2.0)), 0),
    ],
    ids=["all alike", "flesh in the first", "too few in the second", "both", "two have it", "two cuts"],
)
def test_the_cut_with_most_joints_that_others_have_less_those_of_its_own(
    cuts: tuple[tuple[float, ...], ...], which: int
) -> None:
    assert agreeing_cut([tree_at(*heights) for heights in cuts], size()) == which


def test_one_cut_alone_is_the_one() -> None:
    assert agreeing_cut([tree_at(2.0)], size()) == agreeing_cut([tree_at(2.0)], size(), [5]) == 0


class Still(NamedTuple):
    """A tree whose root stays, with joints at these places in every frame."""

    joints: tuple[float, ...]

    @property
    def rest(self) -> np.ndarray:
        return np.array([[0.0, 0.0, z] for z in (0.0, *self.joints)])

    @property
    def motion(self) -> "Still":
        return self

    def carried(self, rest: np.ndarray) -> np.ndarray:
        return np.tile(rest, (FRAMES, 1, 1))


@pytest.mark.parametrize(
    ("cuts", "which"),
    [
        (((1.0, 2.0, 3.0, 4.0, 5.0), (1.0,), (2.0,)), 0),
        (((1.0, 2.0, 3.0, 4.0, 5.0), (), ()), 0),
        (((1.0, 2.0, 3.0), (1.02, 2.0), (1.0, 2.02)), 1),
        (((1.0, 3.0), (1.05, 2.05), (1.1, 2.1)), 0),
    ],
    ids=["less that others have", "nothing", "near", "not near enough"],
)
def test_it_shows_as_much_that_others_have_as_the_first(cuts: tuple[tuple[float, ...], ...], which: int) -> None:
    """Joints are the same within 0.035 of the body's size."""
    assert agreeing_cut([cast(FirstTree, Still(joints)) for joints in cuts], 1.0) == which


@pytest.mark.parametrize(
    ("cuts", "symmetry", "which"),
    [
        (((1.0, 3.0), (1.0, 3.0), (1.0, 3.0)), (0, 3, 0), 1),
        (((1.0, 3.0), (1.0, 3.0), (1.0, 3.0)), (0, 2, 0), 0),
        (((1.0, 3.0), (1.0, 3.0), (1.0, 3.0)), (0, 3, 4), 2),
        (((1.0, 3.0), (1.0, 5.0), (1.0, 3.0)), (0, 4, 0), 0),
        (((1.0, 3.0), (1.0, 5.0), (1.0, 3.0)), (0, 5, 0), 1),
        (((1.0, 5.0), (1.0, 3.0, 4.0), (1.0, 3.0, 4.0)), (2, 2, 2), 0),
        (((1.0, 5.0), (1.0, 3.0, 4.0), (1.0, 3.0, 4.0)), (2, 3, 2), 1),
        (((1.0, 3.0), (1.0, 3.0)), (0, 9), 0),
        (((1.0, 3.0), (1.0, 3.0), (1.0, 3.0)), (0, 3, 3), 1),
        (((1.0, 3.0), (1.0, 3.0, 5.0), (1.0, 3.0)), (0, 6, 5), 2),
        (((1.0, 3.0), (1.0, 3.0, 5.0), (1.0, 3.0)), (0, 7, 5), 1),
        (((1.0,), (1.0, 2.0, 3.0, 4.0, 9.0), (1.0, 2.0, 3.0, 4.0)), (3, 4, 3), 2),
        (((1.0,), (1.0, 2.0, 3.0, 4.0, 9.0), (1.0, 2.0, 3.0, 4.0)), (3, 5, 3), 1),
        (((1.0,), (1.0, 2.0, 3.0, 4.0), (1.0, 2.0, 3.0, 4.0)), (3, 3, 3), 0),
        (((1.0,), (1.0, 2.0, 3.0, 9.0), (1.0, 2.0, 3.0, 4.0, 5.0), (1.0, 2.0, 3.0, 4.0, 5.0)), (3, 5, 3, 2), 2),
        (((1.0,), (1.0, 2.0, 3.0, 4.0, 9.0), (1.0, 2.0, 3.0, 4.0, 5.0), (1.0, 2.0, 3.0, 4.0, 5.0, 8.0)), (3, 4, 2, 3), 1),
        (((1.0,), (1.0, 2.0, 3.0), (1.0, 2.0, 3.0, 4.0, 5.0), (1.0, 2.0, 3.0, 4.0, 5.0)), (3, 4, 3, 0), 2),
        (((1.0,), (1.0, 2.0, 3.0, 9.0), (1.0, 2.0, 3.0), (1.0, 2.0, 3.0)), (0, 3, 2, 2), 2),
        (((1.0, 2.0, 3.0, 4.0, 5.0), (1.0, 2.0, 3.0), (1.0, 4.0, 5.0)), (3, 4, 3), 0),
        (((1.0,), (1.0, 2.0, 3.0, 4.0, 9.0, 8.0), (1.0, 2.0, 3.0, 4.0, 7.0), (1.0,)), (0, 4, 3, 0), 2),
    ],
    ids=[
        "by three", "by two", "the best", "one joint of its own", "more than that", "without more symmetry", "with more",
        "of two cuts", "of equals the first", "of equals that with fewest joints of its own", "of unequals the better",
        "of equals also that with no more symmetry", "of unequals not", "no more symmetry in any",
        "the better of two with no more symmetry", "never one with less symmetry", "of two with as few of their own the better",
        "of two without joints of their own the first",
        "the first, which is best, though another is more symmetric", "fewer joints of its own",
    ],
)  # fmt: skip
def test_where_vertices_were_aligned_another_cut_must_be_more_symmetric_and_clearly_better(
    cuts: tuple[tuple[float, ...], ...], symmetry: tuple[int, ...], which: int
) -> None:
    assert agreeing_cut([cast(FirstTree, Still(joints)) for joints in cuts], 1.0, symmetry) == which


def test_how_far_a_joint_of_another_cut_may_lie() -> None:
    X = np.zeros((FRAMES, 1, 3))
    for share, has in ((0.9, True), (1.1, False)):
        assert in_other_cuts(X, [X + [share * GATE * 7.0, 0.0, 0.0]], 7.0).tolist() == [has]
    assert in_other_cuts(X, [], 7.0).tolist() == [False]
