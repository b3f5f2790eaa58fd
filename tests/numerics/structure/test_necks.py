"""A last part on a narrow tube has a joint at both ends of the tube."""

import numpy as np
import pytest
from bottles import BOTTOM, TOP, bottle

from kinetree.tasks.numerics.structure.necks import NecksSettings, necks
from kinetree.tasks.numerics.structure.still_joints import StillJoint


def necks_of(
    trunk: float = 3.0,
    head: float = 1.8,
    joint: float = BOTTOM,
    others: tuple[float, ...] = (),
    scale: float = 1.0,
    settings: NecksSettings | None = None,
    place: float | None = None,
) -> list[StillJoint]:
    """Of a body with these radii and a neck of radius 1; the head begins at one height, with its joint there or at a place."""
    V, F = bottle(trunk, head)
    label = (V[:, 2] > joint).astype(np.int64)
    heights = np.array([0.0, joint, *others])
    rest = np.stack([0.0 * heights, 0.0 * heights, heights], axis=1)
    rest[1, 2] = joint if place is None else place
    parents = np.array([-1, *[0] * (len(heights) - 1)])
    return list(necks(scale * V, F, label, parents, scale * rest, scale * np.where(parents < 0, 0.0, 1.0), settings))


@pytest.mark.parametrize(("joint", "free"), [(BOTTOM, TOP), (TOP, BOTTOM)])
def test_the_end_without_a_joint_is_the_other_end_of_the_tube(joint: float, free: float) -> None:
    (neck,) = necks_of(joint=joint)
    assert (neck.part, neck.above) == (1, free == BOTTOM)
    np.testing.assert_allclose(neck.centre, [0.0, 0.0, free], atol=0.4)
    assert neck.radius == pytest.approx(1.0, rel=0.05)


def test_the_skin_of_the_tube_follows_the_neck() -> None:
    (neck,) = necks_of()
    z = bottle(3.0, 1.8)[0][:, 2]
    assert neck.share[np.abs(z - (BOTTOM + TOP) / 2) < 0.3].min() > 0.9
    assert not neck.share[(z < BOTTOM - 1.0) | (z > TOP + 1.0)].any()


def test_a_neck_does_not_depend_on_the_unit() -> None:
    (one,), (large,) = necks_of(), necks_of(scale=1000.0)
    np.testing.assert_allclose(large.centre, 1000.0 * one.centre, atol=1e-6)
    np.testing.assert_allclose(large.share, one.share, atol=1e-9)


@pytest.mark.parametrize(("trunk", "head"), [(3.0, 1.1), (1.3, 1.8), (1.0, 1.0)])
def test_a_limb_that_is_not_narrower_than_both_sides_has_none(trunk: float, head: float) -> None:
    assert necks_of(trunk, head) == []


def test_a_tube_with_a_joint_at_both_ends_has_no_other() -> None:
    assert necks_of(others=(TOP,)) == []


@pytest.mark.parametrize(
    ("place", "is_neck"), [(BOTTOM - 1.2, True), (BOTTOM - 1.45, False), (TOP + 1.2, True), (TOP + 1.45, False)]
)
def test_a_joint_that_is_at_neither_end_makes_no_neck(place: float, is_neck: bool) -> None:
    assert bool(necks_of(joint=BOTTOM, place=place)) == is_neck


def test_a_joint_amid_the_tube_is_that_of_the_nearer_end() -> None:
    for joint, free in ((BOTTOM + 0.75, TOP), (TOP - 0.75, BOTTOM)):
        (neck,) = necks_of(joint=joint)
        np.testing.assert_allclose(neck.centre, [0.0, 0.0, free], atol=0.4)


@pytest.mark.parametrize(("apart", "is_neck"), [(0.8, True), (2.2, False)])
def test_the_other_end_must_lie_apart_from_the_joint(apart: float, is_neck: bool) -> None:
    """The ends lie 1.9 radii apart."""
    assert bool(necks_of(settings=NecksSettings(apart=apart))) == is_neck


def test_a_hole_in_a_plain_tube_is_no_neck() -> None:
    V, F = bottle(1.0, 1.0)
    middle = V[F].mean(axis=1)
    around = np.arctan2(middle[:, 1], middle[:, 0])
    open_F = F[~((np.abs(middle[:, 2] - 6.7) < 0.5) & (np.abs(around) < 0.55 * np.pi))]
    label, parents = (V[:, 2] > BOTTOM).astype(np.int64), np.array([-1, 0])
    rest = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, BOTTOM]])
    assert list(necks(V, open_F, label, parents, rest, np.array([0.0, 1.0]))) == []


@pytest.mark.parametrize(("trunk", "head", "count"), [(1.85, 1.8, 0), (2.15, 1.8, 1), (3.0, 1.3, 0), (3.0, 1.5, 1)])
def test_trunk_and_head_are_wider_than_the_tube_by_their_limits(trunk: float, head: float, count: int) -> None:
    assert len(necks_of(trunk, head)) == count


def test_a_part_that_carries_another_hangs_on_no_neck() -> None:
    V, F = bottle(3.0, 1.8)
    label = (V[:, 2] > BOTTOM).astype(np.int64) + (V[:, 2] > TOP + 2.0)
    rest = np.array([[0.0, 0.0, z] for z in (0.0, BOTTOM, TOP + 2.0)])
    assert [neck.part for neck in necks(V, F, label, np.array([-1, 0, 1]), rest, np.array([0.0, 1.0, 1.8]))] == []
