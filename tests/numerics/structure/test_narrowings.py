"""Both limbs of a pair get a joint where they are narrowest."""

import numpy as np
import pytest
from bottles import revolution

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.geodesic_distance import geodesic_distance
from kinetree.tasks.numerics.geometry.surface import Surface
from kinetree.tasks.numerics.structure.joint_partners import RootedParts
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs
from kinetree.tasks.numerics.structure.narrowings import NarrowingsSettings, narrowings
from kinetree.tasks.numerics.structure.still_joints import StillJoint

NARROWING, HAND, END = 15.0, 17.0, 21.0
"""Heights of the narrowing, of radius 1, of where the hand is widest, and of its end; the other limb has them below zero."""
SHOULDER = 5.0
"""Height of the limb's own joint."""


def bar(narrowing: float = NARROWING, below: float = NARROWING, hand: float = 1.7, forearm: float = 2.0) -> tuple[Floats, Ints]:
    """A trunk of radius 3 with a limb above and one below, of this radius at its joint and with a hand beyond its narrowing."""
    limbs = [
        [(4.0, 3.0), (SHOULDER, forearm), (at, 1.0), (at + 2.0, hand), (END - 1.0, hand), (END, 0.4)]
        for at in (below, narrowing)
    ]
    profile = [*((-z, r) for z, r in reversed(limbs[0])), *limbs[1]]
    return revolution([z for z, _ in profile], [r for _, r in profile])


def pairs_of(V: Floats, F: Ints, times: int = 2) -> LimbPairs:
    """Both limbs; twice, since a single pair of limbs says nothing of a body."""
    tips = np.array([len(V) - 1, len(V) - 2])  # amid both ends
    away = geodesic_distance(Surface.of(V, F), tips)
    return LimbPairs(np.tile(tips, (times, 1)), np.tile(away, (times, 1, 1)))


def parts_of(V: Floats, joint: float = SHOULDER) -> RootedParts:
    label = np.where(V[:, 2] > joint, 1, np.where(V[:, 2] < -joint, 2, 0))
    return RootedParts(label, np.array([-1, 0, 0]), np.array([0.0, 2.0, 2.0]))


def found(
    V: Floats, F: Ints, joint: float = SHOULDER, settings: NarrowingsSettings | None = None, times: int = 2
) -> list[StillJoint]:
    rest = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, joint], [0.0, 0.0, -joint]])
    return narrowings(V, F, parts_of(V, joint), rest, pairs_of(V, F, times), settings)


BAR = bar()


def test_a_hand_begins_beyond_the_narrowing_of_each_limb() -> None:
    up, down = found(*BAR)
    assert (up.part, up.above, down.part, down.above) == (1, False, 2, False)
    np.testing.assert_allclose(up.centre, [0.0, 0.0, NARROWING + 0.75], atol=0.3)
    np.testing.assert_allclose(down.centre, [0.0, 0.0, -NARROWING - 0.75], atol=0.3)
    assert up.radius == pytest.approx(1.0, rel=0.05)


def test_the_hand_follows_the_joint_and_the_forearm_stays() -> None:
    z = BAR[0][:, 2]
    for joint, height in zip(found(*BAR), (z, -z), strict=True):
        place = joint.centre[2] if joint.part == 1 else -joint.centre[2]
        assert (joint.share[height < place - 0.7] == 1.0).all()
        assert (joint.share[height > place + 0.8] == 0.0).all()


@pytest.mark.parametrize(("hand", "forearm"), [(1.1, 2.0), (1.7, 1.1), (0.9, 2.0), (1.7, 1.0)])
def test_a_limb_that_is_hardly_wider_on_one_side_has_no_narrowing(hand: float, forearm: float) -> None:
    assert found(*bar(hand=hand, forearm=forearm)) == []


def test_a_narrowing_near_a_joint_is_that_joint() -> None:
    assert len(found(*BAR, joint=10.5)) == 2
    assert found(*BAR, joint=11.5) == []


@pytest.mark.parametrize(("from_end", "count"), [((6.0, 9.0), 2), ((8.0, 9.0), 0), ((3.0, 6.0), 0)])
def test_a_narrowing_near_the_end_is_of_a_finger_and_one_far_from_it_amid_a_bone(
    from_end: tuple[float, float], count: int
) -> None:
    """It lies 7.3 radii from the end."""
    assert len(found(*BAR, settings=NarrowingsSettings(from_end=from_end))) == count


def test_beyond_a_long_bone_is_no_hand() -> None:
    assert len(found(*bar(narrowing=13.0, below=13.0))) == 2
    assert found(*bar(narrowing=11.0, below=11.0)) == []


@pytest.mark.parametrize(("below", "count"), [(NARROWING - 1.0, 2), (NARROWING - 2.5, 0)])
def test_both_limbs_have_it_equally_far_from_their_ends(below: float, count: int) -> None:
    assert len(found(*bar(below=below))) == count


def test_a_limb_whose_partner_has_none_gets_none() -> None:
    V, F = BAR
    V = V.copy()
    low = V[:, 2] < -SHOULDER
    radius = np.linalg.norm(V[low, :2], axis=1, keepdims=True)
    V[low, :2] *= np.minimum(1.0, 1.1 / np.maximum(radius, 1e-9))
    assert found(V, F) == []


def test_a_body_with_a_single_pair_of_limbs_has_none() -> None:
    assert found(*BAR, times=1) == []


def test_a_limb_with_two_ends_has_one_and_one_with_a_part_beyond_none() -> None:
    V, F = BAR
    assert [joint.part for joint in found(V, F, times=3)] == [1, 2]
    parts = parts_of(V)
    hand = np.where(V[:, 2] > 18.0, 3, parts.place)
    more = RootedParts(hand, np.array([-1, 0, 0, 1]), np.array([0.0, 2.0, 2.0, 1.7]))
    rest = np.array([[0.0, 0.0, z] for z in (0.0, SHOULDER, -SHOULDER, 18.0)])
    assert narrowings(V, F, more, rest, pairs_of(V, F)) == []


def test_both_ends_on_one_part_are_no_two_limbs() -> None:
    """As the toes of one foot."""
    V, F = BAR
    label = np.where(V[:, 2] < -SHOULDER - 2.0, 0, 1)
    rest = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, SHOULDER]])
    top = pairs_of(V, F).distance[0, 0]
    tips = np.array([len(V) - 1, len(V) - 3])
    both = LimbPairs(np.stack([tips, tips]), np.tile(top, (2, 2, 1)))
    assert narrowings(V, F, RootedParts(label, np.array([-1, 0]), np.array([0.0, 2.0])), rest, both) == []


def test_limbs_without_a_joint_or_out_of_reach_have_none() -> None:
    V, F = BAR
    whole = RootedParts(np.zeros(len(V), np.int64), np.array([-1]), np.zeros(1))
    assert narrowings(V, F, whole, np.zeros((1, 3)), pairs_of(V, F)) == []
    both = pairs_of(V, F)
    lost = both._replace(distance=np.full_like(both.distance, np.inf))
    rest = np.array([[0.0, 0.0, z] for z in (0.0, SHOULDER, -SHOULDER)])
    assert narrowings(V, F, parts_of(V), rest, lost) == []


@pytest.mark.parametrize("scale", [0.01, 100.0])
def test_size_says_nothing(scale: float) -> None:
    V, F = BAR
    both = pairs_of(V, F)
    scaled = both._replace(distance=scale * both.distance)
    parts = parts_of(V)
    rest = scale * np.array([[0.0, 0.0, z] for z in (0.0, SHOULDER, -SHOULDER)])
    joints = narrowings(scale * V, F, parts._replace(radius=scale * parts.radius), rest, scaled)
    for joint, plain in zip(joints, found(V, F), strict=True):
        np.testing.assert_allclose(joint.centre, scale * plain.centre, atol=1e-9 * scale)
        np.testing.assert_allclose(joint.share, plain.share, atol=1e-9)


def test_rings_that_shrink_to_nothing_are_no_narrowing() -> None:
    """Where the part is cut off obliquely; here a dent of radius 0.2 between the narrowing and the end."""
    V, F = BAR
    dented = V.copy()
    at = np.abs(np.abs(V[:, 2]) - 18.5) < 0.3
    dented[at, :2] *= 0.1
    chosen = NarrowingsSettings(from_end=(1.0, 60.0))  # the dent makes the way to the end longer
    assert [abs(joint.centre[2]) < 17.0 for joint in found(dented, F, settings=chosen)] == [True, True]
    any_radius = chosen._replace(least=0.0)
    assert [abs(joint.centre[2]) > 18.0 for joint in found(dented, F, settings=any_radius)] == [True, True]
