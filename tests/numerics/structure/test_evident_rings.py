"""Which rings are joints, by what they show."""

from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from smeared import turning
from trunk import MIRRORED, trunk

from kinetree.tasks.numerics.structure.evident_rings import EvidentRingsSettings, evident_rings, joint_inwards, needed_score
from kinetree.tasks.numerics.structure.ring_evidence import RingEvidence

_, TREE = trunk(turning())
"""Trunk 0, the part above it 1 with its joint at 2.9, limbs 2 and 3 with joints at −3.2."""
ENOUGH = EvidentRingsSettings().least_score_in_trunk


def ring(part: int, height: float, hung: tuple[int, ...] = (), above: int = 1, level: int = -1) -> Any:
    """A ring of radius 1, of which no more is known; its part's joint lies ten below."""
    centre = np.array([0.0, 0.0, height])
    cut = SimpleNamespace(
        part=part, above=above, hung=hung, centre=centre, radius=1.0, apart=2.0, level=level, is_across_limb=level >= 0
    )
    is_mirrored = part in MIRRORED and not hung and level < 0
    return SimpleNamespace(cut=cut, piece=SimpleNamespace(joint=centre - [0.0, 0.0, 10.0]), is_mirrored=is_mirrored)


def shows(score: float, gain: float = 1.1, far: float = 9.0, near: float = 9.0) -> RingEvidence:
    return RingEvidence(score, gain, far, near)


def found(rings: Sequence[tuple[Any, float]], **settings: float) -> dict[int, float]:
    evidence = [shows(score) for _, score in rings]
    return evident_rings(TREE, [one for one, _ in rings], [evidence], EvidentRingsSettings(**settings))


def limbs(*scores: tuple[float, float], part: int = 0) -> list[tuple[Any, float]]:
    """Rings across both limbs, level by level."""
    return [
        (ring(part, -2.0, (1,), side, level), score)
        for level, both in enumerate(scores)
        for side, score in zip((2, 3), both, strict=True)
    ]


@pytest.mark.parametrize(
    ("rings", "kept"),
    [
        ([(0, 2.2, 0.24), (1, 3.5, 0.23)], [0]),
        ([(0, 2.2, 0.23), (1, 3.5, 0.24)], [1]),
        ([(1, 3.5, 0.24), (0, 2.2, 0.24)], [1]),
        ([(0, -2.5, 0.24), (1, 3.5, 0.23)], [0, 1]),
        ([], []),
    ],
    ids=["the first is better", "the second", "alike", "at two joints", "none"],
)
def test_of_rings_on_both_sides_of_a_joint_the_better_one_is_a_joint(
    rings: list[tuple[int, float, float]], kept: list[int]
) -> None:
    """Of the trunk; one across the last part of a limb has no other side."""
    evident = [(ring(part, height, (2,)), score) for part, height, score in rings]
    end = (ring(3, 3.2), 0.01)
    assert found([*evident, end]) == {**{k: rings[k][2] for k in kept}, len(rings): 0.01}


def test_of_the_rings_across_a_part_of_the_trunk_the_best_and_of_an_end_the_one_that_leaves_least() -> None:
    rings = [ring(0, -2.0, (2,)), ring(0, -1.0, (2,)), ring(2, 4.0), ring(2, 5.0)]
    evidence = [shows(0.2, 1.3), shows(0.3, 1.2), shows(0.2, 1.3), shows(0.3, 1.2)]
    assert evident_rings(TREE, rings, [evidence]) == {1: 0.3, 2: 0.2}


@pytest.mark.parametrize(("gain", "joints"), [(1.2, []), (1.05, [1])])
def test_where_a_ring_close_to_the_joint_before_shows_most_those_beyond_are_none(gain: float, joints: list[int]) -> None:
    chosen, close = EvidentRingsSettings(), ring(1, 4.0)
    close.piece.joint = close.cut.centre - [0.0, 0.0, 1.0]
    between = 0.5 * (chosen.least_score + chosen.least_score_if_short)
    evidence = [shows(between, gain), shows(between, 1.1)]
    assert list(evident_rings(TREE, [close, ring(1, 7.0)], [evidence])) == joints


def test_in_a_limb_with_a_mirror_image_those_beyond_may_be_joints_all_the_same() -> None:
    chosen, close = EvidentRingsSettings(), ring(2, 4.0)
    close.piece.joint = close.cut.centre - [0.0, 0.0, 1.0]
    between = 0.5 * (chosen.least_score + chosen.least_score_if_short)
    assert list(evident_rings(TREE, [close, ring(2, 7.0)], [[shows(between, 1.2), shows(between, 1.1)]])) == [1]


def test_a_part_is_judged_in_the_take_that_shows_most() -> None:
    little, much = [shows(0.1)], [shows(0.3)]
    assert evident_rings(TREE, [ring(0, -2.0, (2,))], [little, much, little]) == {0: 0.3}
    still = [shows(0.3, near=1.0)]
    assert evident_rings(TREE, [ring(0, -2.0, (2,))], [little, still]) == {}


def test_what_a_ring_needs_depends_on_where_it_lies() -> None:
    chosen = EvidentRingsSettings()
    short = ring(1, 2.0)
    short.piece.joint = short.cut.centre - [0.0, 0.0, 1.0]
    needed = [needed_score(one, chosen) for one in (ring(0, 1.0, (2,)), ring(1, 4.0), short)]
    assert needed == [chosen.least_score_in_trunk, chosen.least_score, chosen.least_score_if_short]


def test_of_the_levels_across_both_limbs_that_is_chosen_at_which_both_show_most_together() -> None:
    assert found(limbs((0.20, 0.01), (0.12, 0.11), (0.11, 0.03))) == {2: 0.12, 3: 0.11}


@pytest.mark.parametrize(("scores", "joints"), [((ENOUGH, 0.0), 2), ((0.0, ENOUGH), 2), ((0.9 * ENOUGH, 0.9 * ENOUGH), 0)])
def test_one_limb_that_shows_enough_shows_both(scores: tuple[float, float], joints: int) -> None:
    assert len(found(limbs(scores))) == joints


def test_what_limbs_must_show_is_not_what_the_trunk_must() -> None:
    across = limbs((ENOUGH, 0.0))
    assert len(found(across, least_score_in_trunk=9.0)) == 2
    assert len(found(across, least_score_across_limbs=9.0)) == 0


def test_the_clearer_limb_comes_last() -> None:
    """The frames' poses of what both hang on are those that it shows."""
    assert list(found(limbs((0.2, 0.1)))) == [1, 0]
    assert list(found(limbs((0.1, 0.2)))) == [0, 1]


@pytest.mark.parametrize("still", [{"near": 1.0}, {"far": 1.0}])
def test_both_limbs_must_turn(still: dict[str, float]) -> None:
    rings = [one for one, _ in limbs((0.2, 0.1))]
    assert len(evident_rings(TREE, rings, [[shows(0.2), shows(0.1)]])) == 2
    assert evident_rings(TREE, rings, [[shows(0.2), shows(0.1, **still)]]) == {}
    assert evident_rings(TREE, rings, [[shows(0.2, **still), shows(0.1)]]) == {}


def test_rings_across_limbs_lie_apart_from_joints() -> None:
    both = limbs((0.2, 0.1))
    both[1][0].cut.apart = 0.5
    assert found(both) == {}


def test_both_limbs_are_judged_in_the_take_that_shows_most() -> None:
    rings = [one for one, _ in limbs((0.2, 0.1))]
    assert evident_rings(TREE, rings, [[shows(0.1), shows(0.1)], [shows(0.2), shows(0.3)]]) == {0: 0.2, 1: 0.3}


def test_without_its_limbs_a_part_and_what_lies_beside_its_joint_are_asked_again() -> None:
    """Rings across the part itself, and across the one above it near the joint of both, which is elsewhere then."""
    both, across, beside = limbs((0.1, 0.1)), (ring(0, -2.0, (2, 3)), 0.5), (ring(1, 3.5, (2,)), 0.5)
    assert found([*both, across, beside]) == {0: 0.1, 1: 0.1}
    elsewhere, end = (ring(2, -4.0, (3,)), 0.5), (ring(1, 3.5), 0.5)
    assert found([*both, elsewhere, end]) == {2: 0.5, 3: 0.5, 0: 0.1, 1: 0.1}
    assert found([*limbs((0.01, 0.01)), across, beside]) == {2: 0.5, 3: 0.5}


def test_two_parts_may_hold_limbs() -> None:
    assert len(found([*limbs((0.1, 0.1)), *limbs((0.1, 0.1), part=1)])) == 4


def test_the_joint_inwards_is_that_of_the_lower_part() -> None:
    assert joint_inwards(TREE, ring(1, 0.0, (2, 0)).cut) == 1
    assert joint_inwards(TREE, ring(0, 0.0, (3, 1)).cut) == 1
