"""Joints of mirrored limbs that lie equally far from the ends of their limbs are partners."""

import numpy as np
import pytest
from articulated import Known, chain, surface, swings, three_arms

from kinetree.tasks.numerics.structure.joint_partners import (
    PAIRED,
    Limb,
    RootedParts,
    _partners,
    bone_asymmetry,
    in_mirrored_limbs,
    joint_partners,
    joints_between_pairs,
    mirrored_limbs,
    symmetry,
)
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs, limb_pairs
from kinetree.tasks.numerics.structure.part_tree import MovingParts, PartTree, part_tree


def looked_at(*heights: float) -> tuple[Known, PartTree, LimbPairs]:
    """A tube in parts that bend at these heights, whose ends are a pair; two more on its sides, without which none is known."""
    body = chain(heights, swings(24, len(heights) + 1, 25, seed=2), along=60)
    sides = [int(np.argmin(np.linalg.norm(body.V - [x, 0.0, 0.0], axis=1))) for x in (1.0, -1.0)]
    ends = np.array([body.V[:, 2].argmin(), body.V[:, 2].argmax(), *sides])
    tree = part_tree(surface(body), MovingParts(body.label, body.R, body.t, body.residual))
    return body, tree, limb_pairs(body.V, body.F, ends)


def partners(*heights: float, paired: float = PAIRED) -> dict[float, float]:
    """By height of a joint, that of its partner."""
    body, tree, pairs = looked_at(*heights)
    found = joint_partners(body.F, RootedParts.of(body.label, tree), pairs, paired)
    height = np.append(np.nan, tree.joints.rest[tree.tree.border[1:], 2]).round(1)
    return {float(height[k]): float(height[p]) for k, p in enumerate(found) if p >= 0}


@pytest.mark.parametrize(
    ("heights", "found"),
    [
        ((-1.0, 1.0), {-1.0: 1.0, 1.0: -1.0}),
        ((-3.5, -1.0, 1.0, 3.5), {-3.5: 3.5, -1.0: 1.0, 1.0: -1.0, 3.5: -3.5}),
        ((-3.5, -1.0, 1.0), {-1.0: 1.0, 1.0: -1.0}),
        ((-4.0, 1.0), {}),
    ],
    ids=["a pair", "two pairs", "one without", "too far apart"],
)
def test_equally_far_from_the_ends(heights: tuple[float, ...], found: dict[float, float]) -> None:
    assert partners(*heights) == found


@pytest.mark.parametrize(("paired", "found"), [(0.9, {}), (1.1, {-2.0: 1.0, 1.0: -2.0})])
def test_how_far_apart_they_may_be(paired: float, found: dict[float, float]) -> None:
    """In radii: they differ by one."""
    assert partners(-2.0, 1.0, paired=paired) == found


def test_partners_follow_each_other_alike_though_exchanged_they_differ_by_less_in_radii() -> None:
    """Both joints of the other limb lie nearer to its end; the outer one is narrower."""
    radius = np.array([0.0, 3.76, 3.76, 3.42, 3.42])
    one, other = Limb(np.array([2, 1]), np.array([37.2, 39.7])), Limb(np.array([4, 3]), np.array([35.3, 37.0]))
    np.testing.assert_array_equal(_partners(one, other, radius, PAIRED), [[0, 0], [1, 1]])
    radius[4] = 3.8
    np.testing.assert_array_equal(_partners(one, other, radius, PAIRED), [[0, 0], [1, 1]])


def test_limb_is_told_from_its_end_inwards() -> None:
    body, tree, pairs = looked_at(-3.5, -1.0, 1.0)
    limbs = next(found for found in mirrored_limbs(body.F, RootedParts.of(body.label, tree), pairs) if len(found.one.part))
    levels = sorted((limbs.one.level, limbs.other.level), key=len)
    assert [len(level) for level in levels] == [1, 2]
    np.testing.assert_allclose(levels[1][1] - levels[1][0], 2.5, atol=0.2)
    assert [tree.tree.parents[limb.part[-1]] for limb in (limbs.one, limbs.other)] == [0, 0]
    assert limbs.row.tolist() in ([[1, 0]], [[0, 1]])


def test_body_of_one_part_has_no_partners() -> None:
    body, tree, pairs = looked_at()
    assert joint_partners(body.F, RootedParts.of(body.label, tree), pairs).tolist() == [-1]


def test_body_without_pairs_has_none() -> None:
    body, tree, _ = looked_at(-1.0, 1.0)
    none = LimbPairs(np.zeros((0, 2), np.int64), np.zeros((0, 2, len(body.V))))
    assert joint_partners(body.F, RootedParts.of(body.label, tree), none).tolist() == [-1, -1, -1]


def test_parts_outside_limbs_with_a_mirror_image() -> None:
    """Of three arms two are a pair; the third and the middle are the trunk."""
    body = three_arms()
    tree = part_tree(surface(body), MovingParts(body.label, body.R, body.t, body.residual))
    tip = np.array([[int(np.argmax(body.V @ [np.cos(a), np.sin(a), 0.0])) for a in (0.0, 2 * np.pi / 3)]])
    inside = in_mirrored_limbs(RootedParts.of(body.label, tree), LimbPairs(tip, np.zeros((1, 2, len(body.V)))))
    assert sorted(tree.tree.order[inside].tolist()) == sorted(body.label[tip[0]].tolist())
    assert not in_mirrored_limbs(RootedParts.of(body.label, tree), LimbPairs(tip[:0], np.zeros((0, 2, len(body.V))))).any()


def test_every_part_of_a_chain_but_that_which_carries_both_ends_is_in_a_limb() -> None:
    body, tree, pairs = looked_at(-3.5, -1.0, 1.0, 2.2)
    assert in_mirrored_limbs(RootedParts.of(body.label, tree), pairs).tolist() == [False, True, True, True, True]


@pytest.mark.parametrize(
    ("heights", "count"),
    [((-1.0, 1.0), 1), ((-3.5, -1.0, 1.0, 3.5), 2), ((-3.5, -1.0, 1.0), 0), ((-4.0, 1.0), -2), ((), 0)],
)
def test_symmetry_is_pairs_of_partners_less_joints_without_one(heights: tuple[float, ...], count: int) -> None:
    body, tree, pairs = looked_at(*heights)
    assert symmetry(body.F, RootedParts.of(body.label, tree), pairs) == count


def test_pairs_of_ends_in_the_same_two_limbs_count_their_joints_once() -> None:
    body, tree, pairs = looked_at(-3.5, -1.0, 1.0, 3.5)
    twice = LimbPairs(np.concatenate([pairs.tip, pairs.tip]), np.concatenate([pairs.distance, pairs.distance]))
    parts = RootedParts.of(body.label, tree)
    assert symmetry(body.F, parts, twice) == symmetry(body.F, parts, pairs) == 2
    np.testing.assert_array_equal(joint_partners(body.F, parts, twice), joint_partners(body.F, parts, pairs))


@pytest.mark.parametrize(
    ("parents", "tips", "expected"),
    [
        ((-1, 0, 1, 0, 0, 2, 2), [(3, 4), (5, 6)], [1, 2]),
        ((-1, 0, 0, 0, 0, 1, 1), [(3, 4), (5, 6)], [1]),
        ((-1, 0, 0, 1, 1, 2, 2), [(3, 4), (5, 6)], [1, 2]),
        ((-1, 0, 1, 0, 0, 1, 2), [(3, 4), (5, 6)], [1]),
        ((-1, 0, 0, 0, 0), [(1, 2), (3, 4)], []),
        ((-1, 0, 1, 0, 0, 2, 2), [(5, 6)], []),
        ((-1, 0, 1, 0, 0, 2, 2), [], []),
    ],
    ids=["both lie between", "a tail does not", "the root amid", "one arm hangs lower", "all on one", "one pair", "no pair"],
)
def test_joints_between_pairs_have_both_limbs_of_each_on_one_side(parents, tips, expected) -> None:
    """Every part has one vertex."""
    count = len(parents)
    parts = RootedParts(np.arange(count), np.array(parents), np.ones(count))
    pairs = LimbPairs(np.array(tips, np.int64).reshape(-1, 2), np.zeros((len(tips), 2, count)))
    assert joints_between_pairs(parts, pairs).tolist() == expected


def test_bones_are_mirror_images_where_both_of_their_ends_are() -> None:
    """Arms 1-2-3 and 4-5 on the root: the second bones hang on partners, 3 has none, and 6 and 7 hang on two that are none."""
    parents, partner = np.array([-1, 0, 1, 2, 0, 4, 3, 5]), np.array([-1, 4, 5, -1, 1, 2, 7, 6])
    length = np.array([0.0, 1.0, 2.0, 9.0, 1.5, 2.1, 3.0, 4.0])
    none = np.nan
    np.testing.assert_allclose(bone_asymmetry(parents, partner, length), [none, 0.5, 0.1, none, 0.5, 0.1, none, none])
    np.testing.assert_array_equal(bone_asymmetry(parents, np.full(8, -1), length), np.full(8, none))
