"""A last part on a narrow tube has a joint at the lower end of the tube and one beyond the upper end."""

import numpy as np
import pytest
from bottles import BOTTOM, TOP, bottle

from kinetree.tasks.numerics.structure.necks import NecksSettings, Tube, _places, necks, on_tubes, tubes
from kinetree.tasks.numerics.structure.still_joints import StillJoint

BASE = TOP + NecksSettings().base
"""Height of the upper joint, on a neck of radius 1."""


def tube_of(trunk: float = 3.0, head: float = 1.8, border: float = BOTTOM, scale: float = 1.0) -> list[Tube]:
    """Of a body with these radii and a neck of radius 1; the head's part begins at one height."""
    V, F = bottle(trunk, head)
    label = (V[:, 2] > border).astype(np.int64)
    return tubes(scale * V, F, label, np.array([-1, 0]), scale * np.array([0.0, 1.0]))


def at(*heights: float) -> np.ndarray:
    """(part, xyz) joints of the root, of the head and of further parts at these heights."""
    heights = (0.0, *heights)
    return np.stack([np.zeros(len(heights)), np.zeros(len(heights)), heights], axis=1)


def necks_of(*heights: float, shown: tuple[int, ...] = (), settings: NecksSettings | None = None) -> list[StillJoint]:
    """Necks where the head's joint and those of further parts have these heights."""
    return list(necks(tube_of(), at(*heights), shown, settings))


def test_a_tube_has_a_joint_at_its_lower_end_and_one_beyond_its_upper_end() -> None:
    (tube,) = tube_of()
    assert (tube.part, tube.radius) == (1, pytest.approx(1.0, rel=0.05))
    np.testing.assert_allclose(tube.joint, at(BOTTOM, BASE)[1:], atol=0.2)


def test_a_tube_on_a_slant_has_its_joints_on_its_own_line() -> None:
    V, F = bottle(3.0, 1.8)
    lean = np.array([0.0, 0.3, 0.0])
    bent = V + np.maximum(V[:, 2:] - BOTTOM, 0.0) * lean
    (tube,) = tubes(bent, F, (V[:, 2] > BOTTOM).astype(np.int64), np.array([-1, 0]), np.array([0.0, 1.0]))
    along = (tube.joint[1] - tube.joint[0]) / np.linalg.norm(tube.joint[1] - tube.joint[0])
    assert along @ [0.0, 0.3, 1.0] / np.hypot(0.3, 1.0) > np.cos(np.radians(4.0))


@pytest.mark.parametrize(("joint", "free"), [(BOTTOM, BASE), (BASE, BOTTOM)])
def test_the_joint_that_no_part_has_is_a_neck(joint: float, free: float) -> None:
    (neck,) = necks_of(joint)
    assert (neck.part, neck.above) == (1, free == BOTTOM)
    np.testing.assert_allclose(neck.centre, [0.0, 0.0, free], atol=0.2)
    assert neck.radius == pytest.approx(1.0, rel=0.05)


def test_the_skin_of_the_tube_follows_the_neck() -> None:
    (neck,) = necks_of(BOTTOM)
    z = bottle(3.0, 1.8)[0][:, 2]
    assert neck.share[np.abs(z - (BOTTOM + TOP) / 2) < 0.3].min() > 0.9
    assert not neck.share[(z < BOTTOM - 1.0) | (z > TOP + 1.0)].any()


def test_a_tube_does_not_depend_on_the_unit() -> None:
    (one,), (large,) = tube_of(), tube_of(scale=1000.0)
    np.testing.assert_allclose(large.joint, 1000.0 * one.joint, atol=1e-6)
    np.testing.assert_allclose(large.share, one.share, atol=1e-9)
    (near,), (far,) = (list(necks([tube], scale * at(BOTTOM))) for tube, scale in ((one, 1.0), (large, 1000.0)))
    np.testing.assert_allclose(far.centre, 1000.0 * near.centre, atol=1e-6)


@pytest.mark.parametrize(("trunk", "head"), [(3.0, 1.1), (1.3, 1.8), (1.0, 1.0)])
def test_a_limb_that_is_not_narrower_than_both_sides_has_none(trunk: float, head: float) -> None:
    assert tube_of(trunk, head) == []


@pytest.mark.parametrize(("place", "is_neck"), [(-1.2, True), (-1.45, False)])
def test_a_joint_that_is_at_neither_place_makes_no_neck_and_stays(place: float, is_neck: bool) -> None:
    """So far from the tube's own joint; the tube's joints lie within a tenth of a ring of the bottle's."""
    for joint in (BOTTOM + place, BASE - place):
        assert bool(necks_of(joint)) == is_neck
        moved, stays = on_tubes(tube_of(), at(joint))
        assert stays.tolist() == [False, is_neck]
        assert (moved[1, 2] != joint) == is_neck


@pytest.mark.parametrize(("joint", "own", "free"), [(7.0, BOTTOM, BASE), (7.9, BASE, BOTTOM)])
def test_a_joint_amid_the_tube_is_moved_to_the_nearer_place_and_the_other_is_a_neck(
    joint: float, own: float, free: float
) -> None:
    """Motion shows one joint of two, somewhere between them."""
    hanging = tube_of()
    moved, stays = on_tubes(hanging, at(joint))
    np.testing.assert_allclose(moved, at(own), atol=0.2)
    assert stays.tolist() == [False, True]
    (neck,) = necks(hanging, moved)
    np.testing.assert_allclose(neck.centre, [0.0, 0.0, free], atol=0.2)


@pytest.mark.parametrize(("off", "share"), [(0.35, 0.0), (-0.35, 0.0), (0.6, 0.5), (-0.6, 0.5), (0.85, 1.0)])
def test_a_joint_moves_the_more_the_farther_it_is_astray(off: float, share: float) -> None:
    hanging = tube_of()
    height = hanging[0].joint[0, 2]
    moved, stays = on_tubes(hanging, at(height + off * hanging[0].radius))
    assert (moved[1, 2] - height) / hanging[0].radius == pytest.approx((1.0 - share) * off, abs=0.02)
    assert stays.tolist() == [False, True]


def test_where_no_joint_moves_the_places_are_those_given_and_a_joint_in_its_place_stays() -> None:
    rest = at(BOTTOM)
    places, stays = on_tubes(tube_of(), rest)
    assert places is rest
    assert stays.tolist() == [False, True]
    assert on_tubes([], rest)[0] is rest
    assert not on_tubes([], rest)[1].any()


def test_a_tube_with_a_joint_at_both_places_has_no_other() -> None:
    assert necks_of(BASE, BOTTOM) == []
    assert necks_of(BOTTOM, BASE) == []


@pytest.mark.parametrize(("below", "has_third"), [(0.5, False), (0.8, True)])
def test_a_joint_amid_the_tube_is_a_third_one_where_the_lower_one_is_known(below: float, has_third: bool) -> None:
    """It stays, and the upper one is a neck; nearer to the upper one it is that."""
    hanging = tube_of()
    rest = at(BASE - below, BOTTOM)
    moved, stays = on_tubes(hanging, rest)
    found = list(necks(hanging, moved))
    assert (len(found), stays[1]) == (has_third, True)
    assert (moved[1, 2] == rest[1, 2]) == has_third
    if has_third:
        assert (found[0].part, found[0].above) == (1, False)
        np.testing.assert_allclose(found[0].centre, [0.0, 0.0, BASE], atol=0.2)


def test_a_tube_has_no_fourth_joint() -> None:
    """One at its lower end, another one amid it; the part's own is the upper one, though far from its place."""
    rest = at(BASE - 0.85, BOTTOM, BOTTOM + 1.0)
    assert list(necks(tube_of(), rest)) == []
    moved, _ = on_tubes(tube_of(), rest)
    np.testing.assert_allclose(moved[1], [0.0, 0.0, BASE], atol=0.2)


def test_joints_beside_a_tube_are_not_on_it() -> None:
    """As shoulders lie beside a neck."""
    rest = at(BASE - 0.85, BOTTOM, BOTTOM + 1.0)
    rest[3, 0] = 2.0
    assert len(list(necks(tube_of(), rest))) == 1


@pytest.mark.parametrize(
    ("joint", "others", "shown"),
    [(6.2, (BOTTOM, 7.2), ()), (4.8, (BOTTOM, 7.0), ()), (BOTTOM, (BOTTOM,), (1,)), (5.0, (BOTTOM,), (1,))],
)
def test_a_joint_near_the_lower_place_is_not_moved_to_the_upper_one_if_another_part_has_the_lower(
    joint: float, others: tuple[float, ...], shown: tuple[int, ...]
) -> None:
    hanging, rest = tube_of(), at(joint, *others)
    moved, stays = on_tubes(hanging, rest, shown)
    assert moved is rest
    assert not stays.any()
    assert list(necks(hanging, rest, shown)) == []


@pytest.mark.parametrize(("above", "is_third"), [(-0.5, False), (0.0, False), (0.5, False), (0.8, True)])
def test_a_third_joint_lies_between_both_places(above: float, is_third: bool) -> None:
    assert bool(necks_of(BOTTOM + above, BOTTOM)) == is_third


def test_joints_on_the_upper_half_of_a_tube_are_on_it() -> None:
    assert len(list(necks(tube_of(), at(BASE - 1.2, BOTTOM)))) == 1
    assert list(necks(tube_of(), at(BASE - 1.2, BOTTOM, BASE - 1.0))) == []


def test_the_root_has_no_place_on_a_tube() -> None:
    rest = at(BASE)
    rest[0, 2] = BOTTOM
    assert len(list(necks(tube_of(), rest))) == 1


def test_places_go_by_the_narrow_rings_and_the_radius_of_the_tube_whatever_the_border() -> None:
    """A neck that widens upwards by a fifth: it is narrow to its middle."""
    V, F = bottle(3.0, 1.8)
    z = V[:, 2]
    wider = np.where((z > BOTTOM) & (z <= TOP), 1.0 + 0.2 * (z - BOTTOM) / (TOP - BOTTOM), 1.0)
    V = V * np.stack([wider, wider, np.ones(len(V))], axis=1)
    label, parents = (z > BOTTOM).astype(np.int64), np.array([-1, 0])
    for border in (0.8, 1.0, 1.4):
        (tube,) = tubes(V, F, label, parents, np.array([0.0, border]))
        np.testing.assert_allclose(tube.joint, at(BOTTOM, (BOTTOM + TOP) / 2 + NecksSettings().base)[1:], atol=0.3)


LEANING = [[0.0, 0, 0], [0.05, 0, 0.5], [0.1, 0, 1.0], [0.15, 0, 1.5], [0.6, 0, 2.0]]
ACROSS = [[0.0, 0, 0], [0.3, 0, 1.0], [-0.3, 0, 1.1], [0.3, 0, 1.2], [0.0, 0, 2.0]]


@pytest.mark.parametrize(("middle", "first", "along"), [(LEANING, 0, [0.1, 0.0, 1.0]), (ACROSS, 1, [0.0, 0.0, 1.0])])
def test_the_line_of_a_tube_goes_through_its_narrow_rings_unless_they_lie_across_it(
    middle: list[list[float]], first: int, along: list[float]
) -> None:
    chosen, is_narrow = NecksSettings(), np.array([first == 0, True, True, True, False])
    low, high = _places(np.array(middle), is_narrow, chosen.base, chosen.oblique)
    axis = (high - low) / np.linalg.norm(high - low)
    np.testing.assert_allclose(axis, np.array(along) / np.linalg.norm(along), atol=0.03)


def test_a_joint_beyond_the_upper_place_is_no_third_one() -> None:
    assert necks_of(BASE + 0.9, BOTTOM) == []


def test_a_part_that_surfaces_show_has_no_joint_more_and_is_moved() -> None:
    hanging, rest = tube_of(), at(BASE - 0.85, BOTTOM)
    moved, _ = on_tubes(hanging, rest, shown=(1,))
    np.testing.assert_allclose(moved[1], [0.0, 0.0, BASE], atol=0.2)
    assert list(necks(hanging, rest, shown=(1,))) == necks_of(BOTTOM, shown=(1,)) == []


@pytest.mark.parametrize(("apart", "is_neck"), [(2.5, True), (3.2, False)])
def test_the_other_place_must_lie_apart_from_the_joint(apart: float, is_neck: bool) -> None:
    """The places lie 2.85 radii apart."""
    assert bool(necks_of(BOTTOM, settings=NecksSettings(apart=apart))) == is_neck


def test_a_hole_in_a_plain_tube_is_no_neck() -> None:
    V, F = bottle(1.0, 1.0)
    middle = V[F].mean(axis=1)
    around = np.arctan2(middle[:, 1], middle[:, 0])
    open_F = F[~((np.abs(middle[:, 2] - 6.7) < 0.5) & (np.abs(around) < 0.55 * np.pi))]
    label, parents = (V[:, 2] > BOTTOM).astype(np.int64), np.array([-1, 0])
    assert tubes(V, open_F, label, parents, np.array([0.0, 1.0])) == []


@pytest.mark.parametrize(("trunk", "head", "count"), [(1.6, 1.8, 0), (1.9, 1.8, 1), (3.0, 1.3, 0), (3.0, 1.5, 1)])
def test_trunk_and_head_are_wider_than_the_tube_by_their_limits(trunk: float, head: float, count: int) -> None:
    assert len(tube_of(trunk, head)) == count


def test_a_part_that_carries_another_hangs_on_no_neck() -> None:
    V, F = bottle(3.0, 1.8)
    label = (V[:, 2] > BOTTOM).astype(np.int64) + (V[:, 2] > TOP + 2.0)
    assert [tube.part for tube in tubes(V, F, label, np.array([-1, 0, 1]), np.array([0.0, 1.0, 1.8]))] == []
