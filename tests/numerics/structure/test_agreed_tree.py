"""Whose tree it is, and that joints of one cut alone go if the tree needs them not."""

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from articulated import ALL_STAY, Known, chain, swings
from ringed import FRAMES, HEIGHTS, TIPS, OtherTree, body, cut_of, heights, joints_at, ringed
from shipped import TREE
from smeared import moving

from kinetree.tasks.numerics.structure import agreed_tree as numerics
from kinetree.tasks.numerics.structure.agreed_tree import AgreedTree, agreed_tree
from kinetree.tasks.numerics.structure.first_tree import FirstTree, first_tree
from kinetree.tasks.numerics.structure.joint_evidence import FrameEvidence
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.pruning import Dropped, Pruned
from kinetree.tasks.numerics.structure.tree_joints import Cut, TreeJoints

TOPMOST = 4
"""The part beyond the last joint, in the order of a tree with a ring."""


def left(tree: FirstTree, others: list[FirstTree]) -> FirstTree:
    found = agreed_tree(moving(body()), [tree, *others], TIPS, None, settings=ALL_STAY)
    assert found.which == 0
    return found.tree


def test_ring_that_no_other_cut_has_goes_and_says_why() -> None:
    tree = ringed(0.15)
    assert len(heights(tree)) == 4
    found = left(tree, [joints_at(*HEIGHTS)] * 2)
    np.testing.assert_allclose(heights(found), HEIGHTS, atol=0.1)
    assert [(d.part, d.reason) for d in found.graph.dropped] == [(4, "alone")]
    assert found.place[4] == -1
    assert sorted(found.place[:4].tolist()) == [0, 1, 2, 3]
    true = body()
    for part in range(4):
        np.testing.assert_allclose(found.R[:, found.place[part]], true.R[:, part], atol=1e-9)
    np.testing.assert_array_equal(found.graph.part, tree.graph.part)


@pytest.mark.parametrize(
    "others",
    [[], [joints_at(*HEIGHTS), joints_at(-3.0, 0.0, 0.9, 2.6)]],
    ids=["no other cut", "one of two has it"],
)
def test_it_stays_where_no_other_cut_is_or_one_has_it(others: list[FirstTree]) -> None:
    tree = ringed(0.15)
    assert left(tree, others) is tree


def test_true_joint_that_other_cuts_miss_stays_since_its_neighbours_would_drift_more() -> None:
    tree = ringed(0.0, (4.0, 4.1))
    others = [joints_at(-3.0, 2.6), joints_at(-3.0, 2.6)]
    assert left(tree, others) is tree


def test_last_part_of_a_limb_stays() -> None:
    """Without it no joint would come in the place of its own."""
    tree = ringed(0.15, (4.0, 5.1))
    assert left(tree, [joints_at(*HEIGHTS)] * 2) is tree


@pytest.mark.parametrize(("rise", "stays"), [(1.14, False), (1.16, True)])
def test_how_much_more_joints_may_drift_without_it(rise: float, stays: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    tree = ringed(0.15)
    monkeypatch.setattr(numerics, "_rise", lambda *of: rise)
    assert (left(tree, [joints_at(*HEIGHTS)] * 2) is tree) == stays


@pytest.mark.parametrize(("fewer", "stays"), [(1, False), (2, True)])
def test_it_stays_if_two_limbs_become_one_without_it(fewer: int, stays: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Mirrored limbs have 8 parts with the ring, and so many fewer without it."""
    monkeypatch.setattr(numerics, "_in_limbs", lambda left, _: 8 - fewer * (len(left.origin) == 4))
    found = left(ringed(0.15), [joints_at(*HEIGHTS)] * 2)
    assert len(heights(found)) == (4 if stays else 3)


def test_of_two_cuts_neither_is_in_the_majority() -> None:
    tree = ringed(0.15)
    assert left(tree, [joints_at(*HEIGHTS)]) is tree


def test_both_of_two_rings_go_the_one_first_without_which_joints_drift_least(monkeypatch: pytest.MonkeyPatch) -> None:
    tree = cut_of(body(), ((-3.0, -2.1), 0.3), ((2.6, 3.5), 0.1))
    assert len(heights(tree)) == 5
    for low, high in ((4, 5), (5, 4)):
        rises = {int(tree.place[low]): 0.5, int(tree.place[high]): 0.9}
        monkeypatch.setattr(numerics, "_rise", lambda before, after, rises=rises: rises.get(after.left.dropped[-1].part, 9.0))
        found = left(tree, [joints_at(*HEIGHTS)] * 2)
        np.testing.assert_allclose(heights(found), HEIGHTS, atol=0.1)
        assert [d.part for d in found.graph.dropped] == [low, high]


def test_parts_dropped_before_stay_dropped() -> None:
    tree = ringed(0.15)
    before = tree._replace(place=np.append(tree.place, -1), graph=tree.graph._replace(dropped=(Dropped(5, "still"),)))
    found = left(before, [joints_at(*HEIGHTS)] * 2)
    assert [(d.part, d.reason) for d in found.graph.dropped] == [(5, "still"), (4, "alone")]
    assert found.place[[4, 5]].tolist() == [-1, -1]


def test_joint_stays_if_what_lies_beyond_would_go_with_it() -> None:
    """Without a leaf at its end what lies beyond slides when two joints become one: true joints would be lost."""
    true = chain((-1.0, 1.0, 3.0), swings(FRAMES, 4, 15, seed=2), along=60)
    noise = 0.02 * np.random.default_rng(0).normal(size=true.t.shape)
    cut = Cut(true.V, true.label, true.R, true.t + noise, true.residual)
    tree = first_tree(moving(true), cut, TIPS, settings=TREE)
    assert len(heights(tree)) == 3
    joint = (true.R[:, 1] @ [0.0, 0.0, -1.0] + true.t[:, 1])[:, None]
    others = [cast(FirstTree, OtherTree(joint))] * 2
    assert agreed_tree(moving(true), [tree, *others], TIPS, None, settings=TREE).tree is tree


def tree_of(parents: list[int], order: list[int], origin: list[int], drift: list[float]) -> TreeJoints:
    """A tree of which no more than this is known."""
    tree = SimpleNamespace(parents=np.array(parents), order=np.array(order))
    left = SimpleNamespace(part_tree=SimpleNamespace(tree=tree), origin=np.array(origin))
    return cast(TreeJoints, SimpleNamespace(left=left, drift=np.array(drift)))


def test_rise_is_the_largest_drift_of_new_joints_in_that_of_those_gone() -> None:
    """Part 1 goes from the chain 2 – 0 – 1 – 3, and 0 meets 3; the numbers after it move up."""
    before = tree_of([-1, 0, 1, 2], [2, 0, 1, 3], [0, 1, 2, 3], [0.0, 9.0, 0.2, 0.5])
    after = tree_of([-1, 0, 1], [1, 0, 2], [0, 2, 3], [0.0, 9.0, 0.4])
    assert numerics._rise(before, after) == pytest.approx(0.4 / 0.5)


def test_rise_is_infinite_where_no_joint_comes() -> None:
    before, after = tree_of([-1, 0, 1], [0, 1, 2], [0, 1, 2], [0.0, 0.2, 0.5]), tree_of([-1], [0], [0], [0.0])
    assert numerics._rise(before, after) == np.inf


@pytest.mark.parametrize(("other_has", "goes"), [((), True), ((2,), False)])
def test_parts_that_are_weak_without_it_go_too_if_their_joints_are_this_cuts_alone(
    other_has: tuple[int, ...], goes: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without the ring another part is weak, that beyond the last joint."""
    tree, real = ringed(0.15), numerics.pruned_without

    def with_another(body: MovingSurface, joints: Pruned, part: int, *of: Any) -> Pruned:
        less = real(body, joints, part, *of)
        last = [k for k in range(len(less.origin)) if less.origin[k] == TOPMOST]
        return real(body, less, last[0], *of) if last and len(less.dropped) == 1 else less

    monkeypatch.setattr(numerics, "pruned_without", with_another)
    others = [joints_at(*HEIGHTS[:2], *(HEIGHTS[k] for k in other_has))] * 2
    assert (len(left(tree, others).parents) == len(tree.parents) - 2) == goes


def test_joint_that_others_have_is_not_lost_for_it() -> None:
    """Another cut has a joint in the ring's place and none at the true one."""
    tree = ringed(0.15)
    assert left(tree, [joints_at(-3.0, 0.9, 2.6)] * 2) is tree


def tube(*heights: float) -> Known:
    return chain(heights, swings(FRAMES, len(heights) + 1, 25, seed=2), along=60)


def bent_at(*heights: float) -> FirstTree:
    """The tree of a tube bent at these heights."""
    return cut_of(tube(*heights))


def of_pair(trees: list[FirstTree], evidence: FrameEvidence | None = None) -> AgreedTree:
    """The ends of the tube are a pair."""
    true = tube(-2.0, 2.0)
    sides = [int(np.argmin(np.linalg.norm(true.V - [x, 0.0, 0.0], axis=1))) for x in (1.0, -1.0)]
    tips = np.array([true.V[:, 2].argmin(), true.V[:, 2].argmax(), *sides])
    return agreed_tree(moving(true), trees, tips, None, evidence, settings=ALL_STAY)


def test_tree_of_a_cut_with_more_partners_is_used() -> None:
    """A joint at one end alone has no partner, which the other two cuts have."""
    one, two = bent_at(2.0), bent_at(-2.0, 2.0)
    assert of_pair([two, one, one]).which == 0
    found = of_pair([one, two, two])
    assert found.which == 1
    np.testing.assert_allclose(heights(found.tree), [-2.0, 2.0], atol=0.1)
    np.testing.assert_array_equal(found.tree.graph.pair, two.graph.pair)
    assert of_pair([one, two]).which == 0, "of two cuts neither is in the majority"


def test_tree_of_another_cut_needs_the_evidence_that_the_first_has(monkeypatch: pytest.MonkeyPatch) -> None:
    asked, whole = [], numerics.tree_joints
    evidence = cast(FrameEvidence, "the frames")
    monkeypatch.setattr(
        numerics, "tree_joints", lambda *of, settings: asked.append(of[4]) or whole(*of[:4], None, settings=settings)
    )
    one, two = bent_at(2.0), bent_at(-2.0, 2.0)
    of_pair([two, one, one], evidence)
    assert asked == []
    of_pair([one, two, two], evidence)
    assert asked == [evidence]


def test_of_another_cut_the_joint_that_it_has_alone_goes_too(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its tree has joints at both ends, as the third cut, and a ring that slides."""
    slid = cut_of(tube(-2.0, 2.0), ((2.0, 2.9), 0.15))
    assert len(slid.parents) == 4
    one, two = bent_at(2.0), bent_at(-2.0, 2.0)
    monkeypatch.setattr(numerics, "agreeing_cut", lambda *of: 1)
    found = of_pair([one, slid, two])
    assert found.which == 1
    np.testing.assert_allclose(heights(found.tree), [-2.0, 2.0], atol=0.1)
    assert [(d.part, d.reason) for d in found.tree.graph.dropped] == [(3, "alone")]


def test_first_tree_stays_if_the_frames_do_not_show_what_the_other_has_more(monkeypatch: pytest.MonkeyPatch) -> None:
    one, two = bent_at(2.0), bent_at(-2.0, 2.0)
    monkeypatch.setattr(numerics, "tree_joints", lambda *of, settings: None)
    monkeypatch.setattr(numerics, "_of_cut", lambda tree, joints: one)
    found = of_pair([one, two, two], cast(FrameEvidence, "the frames"))
    assert found.which == 0
    assert found.tree is one
