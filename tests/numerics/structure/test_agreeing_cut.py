"""Which cut gives the tree where every vertex was followed."""

from typing import NamedTuple, cast

import numpy as np
import pytest
from articulated import Known, chain, cut_by_height, swings

from kinetree.tasks.numerics.structure.agreeing_cut import CutJoints, agreeing_cut, first_cut
from kinetree.tasks.numerics.structure.first_tree import FirstTree, in_tree_order

FRAMES = 16


def body() -> Known:
    return chain((-2.0, 2.0), swings(FRAMES, 3, seed=1))


def tree_at(*heights: float) -> FirstTree:
    """The tree of a cut at these heights; true joints are at −2 and 2."""
    return in_tree_order(cut_by_height(body(), heights), len(heights) + 1)


JOINTS = CutJoints(np.full((FRAMES, 1, 3), 1.0), np.full((FRAMES, 1, 3), 2.0))
"""Other joints for each kind, so that one sees which were taken."""


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
    first, *others = (tree_at(*heights) for heights in cuts)
    found = agreeing_cut(first, others, [JOINTS] * len(others), size())
    assert found.which == which
    assert found.tree is [first, *others][which]
    own = first.motion.carried(first.rest[1:])
    for k, joints in enumerate(found.further, start=1):
        np.testing.assert_array_equal(joints, own if k == which else np.full((FRAMES, 1, 3), 1.0))


def test_joints_of_other_cuts_have_hidden_bones_if_the_tree_has_some() -> None:
    tree = tree_at(-2.0, 2.0)
    with_bone = tree._replace(place=np.append(tree.place[:-1], -1))
    assert with_bone.has_bones
    for first, kind in ((tree, 1.0), (with_bone, 2.0)):
        for found in (agreeing_cut(first, [tree] * 2, [JOINTS] * 2, size()), first_cut(first, [JOINTS])):
            assert (found.which, found.further[0][0, 0, 0]) == (0, kind)


def test_one_cut_alone_is_the_one() -> None:
    tree = tree_at(2.0)
    assert agreeing_cut(tree, [], [], size()) == (0, tree, [])


class Still(NamedTuple):
    """A tree whose root stays, with joints at these places in every frame."""

    joints: tuple[float, ...]
    has_bones: bool = False

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
    first, *others = (cast(FirstTree, Still(joints)) for joints in cuts)
    assert agreeing_cut(first, others, [JOINTS] * 2, 1.0).which == which
