"""Laws of joints that are one joint with several bones."""

import numpy as np
import pytest
from articulated import swings

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.structure.first_tree import FirstTree, PartGraph
from kinetree.tasks.numerics.structure.shared_joints import SharedJointsSettings, shared_joints

FRAMES, RADIUS, SIZE = 24, 1.0, 20.0


def star(joints: Floats, off: Floats, noise: float = 0.02, axes: int = 2, scale: float = 1.0) -> tuple[FirstTree, Floats]:
    """Limbs that turn about joints of a root that moves, with noise in where they are · joints that far off them."""
    count = len(joints) + 1
    turn, rng = swings(FRAMES, count, 25.0, axes), np.random.default_rng(0)
    R, t = turn.copy(), np.empty((FRAMES, count, 3))
    t[:, 0] = scale * rng.normal(size=(FRAMES, 3))
    for k, joint in enumerate(joints, 1):
        R[:, k] = turn[:, 0] @ turn[:, k]
        t[:, k] = turn[:, 0] @ (scale * joint) + t[:, 0] - R[:, k] @ (scale * joint)
        t[:, k] += noise * scale * rng.normal(size=(FRAMES, 3))
    rest = scale * np.concatenate([np.zeros((1, 3)), joints + off])
    none = np.zeros(0)
    graph = PartGraph(np.zeros(0, np.int64), np.zeros((0, 2), np.int64), np.zeros((0, 3)), none, none, ())
    tree = FirstTree(
        parents=np.array([-1, *[0] * len(joints)]), place=np.arange(count), shown=(), label=np.zeros(1, np.int64),
        W=np.zeros((1, count)), R=R, t=t, certain_share=None, rest=rest, drift=np.zeros(count),
        unexplained=np.zeros((FRAMES, count)), radius=scale * np.array([0.0, *[RADIUS] * len(joints)]),
        end_x=np.zeros((FRAMES, 0, 3)), graph=graph,
    )  # fmt: skip
    return tree, rest


AT = np.array([3.0, 0.0, 1.0])
ASIDE = np.array([[0.3, 0.0, 0.0], [-0.3, 0.0, 0.0]])
LOOSE = 0.2
"""Noise so large that a joint 0.3 off drifts hardly more."""


def test_bones_of_one_joint_meet_where_all_of_them_turn() -> None:
    tree, rest = star(np.array([AT, AT]), ASIDE, LOOSE)
    places, is_shared = shared_joints(tree, rest, SIZE)
    np.testing.assert_array_equal(places[1], places[2])
    assert np.linalg.norm(places[1] - AT) < 0.15
    np.testing.assert_array_equal(places[0], rest[0])
    assert is_shared.tolist() == [False, True, True]


def test_three_bones_of_one_joint_meet() -> None:
    tree, rest = star(np.array([AT] * 3), np.array([*ASIDE, [0.0, 0.3, 0.0]]), LOOSE)
    places, is_shared = shared_joints(tree, rest, SIZE)
    assert (places[1:] == places[1]).all()
    assert np.linalg.norm(places[1] - AT) < 0.15
    assert is_shared.tolist() == [False, True, True, True]


def test_near_joints_that_both_motions_tell_apart_stay() -> None:
    tree, rest = star(np.array([AT, AT + [0.6, 0.0, 0.0]]), np.zeros((2, 3)))
    places, is_shared = shared_joints(tree, rest, SIZE)
    assert places is rest
    assert not is_shared.any()


@pytest.mark.parametrize(("shown", "is_one"), [((), True), ((1,), True), ((1, 2), False), ((2, 3), True)])
def test_joints_that_the_frames_surfaces_show_are_not_one(shown: tuple[int, ...], is_one: bool) -> None:
    """Both of them; a third joint lies elsewhere."""
    tree, rest = star(np.array([AT, AT, -AT]), np.array([*ASIDE, np.zeros(3)]), LOOSE)
    assert shared_joints(tree._replace(shown=shown), rest, SIZE).is_shared.tolist() == [False, is_one, is_one, False]


def test_joints_farther_apart_than_their_borders_are_wide_stay_whatever_the_motion_says() -> None:
    """Both hinges turn about the line through both joints, so that each explains the other's motion."""
    apart = np.array([AT, AT + [1.2, 0.0, 0.0]])
    tree, rest = star(apart, np.zeros((2, 3)), axes=1)
    assert shared_joints(tree, rest, SIZE).rest is rest
    wide = shared_joints(tree, rest, SIZE, settings=SharedJointsSettings(near=1.5)).rest
    np.testing.assert_array_equal(wide[1], wide[2])


def test_joints_that_a_motion_would_rather_have_farther_apart_stay() -> None:
    """The second turns about a place that lies farther off than where it is put, and at the first it drifts little more."""
    tree, rest = star(np.array([AT, AT + [0.6, 0.0, 0.0]]), np.array([[0.0, 0.0, 0.0], [-0.25, 0.0, 0.0]]), LOOSE / 2)
    assert shared_joints(tree, rest, SIZE).rest is rest
    merged = shared_joints(tree, rest, SIZE, settings=SharedJointsSettings(lean=np.inf)).rest
    np.testing.assert_array_equal(merged[1], merged[2])


def test_joints_on_different_parts_stay() -> None:
    tree, rest = star(np.array([AT, AT]), ASIDE, LOOSE)
    assert shared_joints(tree._replace(parents=np.array([-1, 0, 1])), rest, SIZE).rest is rest


@pytest.mark.parametrize(("apart", "is_one"), [(0.85, True), (0.95, False)])
def test_joints_are_one_until_the_common_place_drifts_half_as_much_again(apart: float, is_one: bool) -> None:
    tree, rest = star(AT + np.array([[-0.5, 0.0, 0.0], [0.5, 0.0, 0.0]]) * apart, np.zeros((2, 3)), noise=0.08)
    rise = (tree.drift_at(np.array([rest[0], AT, AT]))[1:] / tree.drift_at(rest)[1:]).max()
    assert rise == pytest.approx(1.45 if is_one else 1.55, abs=0.04)
    assert shared_joints(tree, rest, SIZE).is_shared[1:].tolist() == [is_one, is_one]


@pytest.mark.parametrize(("noise", "least", "most"), [(0.02, 0.3, 0.9), (0.5, 0.0, 0.1)])
def test_the_common_place_leaves_its_joints_as_far_as_motion_is_clear(noise: float, least: float, most: float) -> None:
    """Both joints lie off where the bones turn, by a third of the border: clear motion brings them half way, loose none."""
    off = np.array([0.0, 0.3, 0.0])
    tree, rest = star(np.array([AT, AT]), ASIDE / 3 + off, noise)
    places, is_shared = shared_joints(tree, rest, SIZE)
    assert is_shared[1:].all()
    assert least < np.linalg.norm(places[1] - AT - off) / 0.3 < most


def test_of_five_joints_on_a_part_two_pairs_are_one_each() -> None:
    alone, there = np.array([-5.0, 0.0, 1.0]), np.array([0.0, 5.0, 1.0])
    tree, rest = star(np.array([AT, there, alone, AT, there]), np.array([ASIDE[0], ASIDE[0], [0.0] * 3, *ASIDE[[1, 1]]]), LOOSE)
    places, is_shared = shared_joints(tree, rest, SIZE)
    assert is_shared.tolist() == [False, True, True, False, True, True]
    np.testing.assert_array_equal(places[~is_shared], rest[~is_shared])
    np.testing.assert_array_equal(places[[1, 2]], places[[4, 5]])
    assert np.linalg.norm(places[1] - places[2]) > 1.0


def test_joints_that_one_take_tells_apart_stay() -> None:
    """Of four takes three are so noisy that over all frames one place would do."""
    calm, loose = (star(np.array([AT, AT + [0.6, 0.0, 0.0]]), np.zeros((2, 3)), noise)[0] for noise in (0.02, 0.8))
    R, t = (np.concatenate([getattr(calm, name), *[getattr(loose, name)] * 3]) for name in ("R", "t"))
    takes = [slice(k * FRAMES, (k + 1) * FRAMES) for k in range(4)]
    tree = calm._replace(R=R, t=t)
    as_one = shared_joints(tree, calm.rest, SIZE).rest
    np.testing.assert_array_equal(as_one[1], as_one[2])
    assert shared_joints(tree, calm.rest, SIZE, takes).rest is calm.rest


def test_the_smaller_border_says_what_is_near() -> None:
    tree, rest = star(np.array([AT, AT]), ASIDE, LOOSE)
    assert shared_joints(tree._replace(radius=np.array([0.0, 5.0, 0.5])), rest, SIZE).rest is rest


@pytest.mark.parametrize("scale", [0.001, 1000.0])
def test_the_same_on_a_body_of_another_size(scale: float) -> None:
    one, other = (shared_joints(*star(np.array([AT, AT]), ASIDE, LOOSE, scale=s), SIZE * s).rest / s for s in (1.0, scale))
    np.testing.assert_allclose(other, one, rtol=1e-9)


def test_a_body_that_is_one_part_has_none() -> None:
    tree, rest = star(np.zeros((0, 3)), np.zeros((0, 3)))
    assert shared_joints(tree, rest, SIZE).rest is rest
