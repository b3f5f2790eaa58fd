"""A joint at the end of a limb that its mirror image has is added at the same distance from the end."""

import numpy as np
import pytest
from shapes import y_pipe

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.geometry.geodesic_distance import geodesic_distance
from kinetree.tasks.numerics.geometry.surface import Surface
from kinetree.tasks.numerics.structure.joint_partners import RootedParts
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs
from kinetree.tasks.numerics.structure.mirrored_joints import MirroredJointsSettings, mirrored_joints
from kinetree.tasks.numerics.structure.still_joints import StillJoint

V, F, _ = y_pipe()
"""A trunk along x from the fork at 0, and two legs of radius 4 at 60° on either side of −x, which end 28 from the fork."""
TIPS = np.array([np.argmax(V[:, 1]), np.argmin(V[:, 1])])
AWAY = geodesic_distance(Surface.of(V, F), TIPS)
PAIRS = LimbPairs(np.stack([TIPS, TIPS]), np.stack([AWAY, AWAY]))
"""Both legs, twice, since a single pair of limbs says nothing of a body."""
RADIUS = 3.6
"""Of the borders across a leg, about."""


def parts(one: tuple[float, ...], other: tuple[float, ...]) -> tuple[RootedParts, Floats]:
    """The pipe cut across both legs at these distances from their ends, outermost first; and its joints."""
    label, rest, parents = np.zeros(len(V), np.int64), [V[V[:, 0] > 6.0].mean(axis=0)], [-1]
    for away, levels in zip(AWAY, (one, other), strict=True):
        above = 0
        for level in sorted(levels, reverse=True):
            label[away < level] = len(parents)
            rest.append(V[np.abs(away - level) < 1.0].mean(axis=0))
            parents.append(above)
            above = len(parents) - 1
    radius = np.where(np.arange(len(parents)) > 0, RADIUS, 0.0)
    return RootedParts(label, np.array(parents), radius), np.array(rest)


def found(
    one: tuple[float, ...],
    other: tuple[float, ...],
    settings: MirroredJointsSettings | None = None,
    pairs: LimbPairs | None = None,
) -> list[StillJoint]:
    of, rest = parts(one, other)
    return mirrored_joints(V, F, of, rest, PAIRS if pairs is None else pairs, settings=settings)


def level(joint: StillJoint, side: int) -> float:
    """Mean distance from the end of a leg of the vertices nearest to the ring."""
    return float(AWAY[side][np.abs(joint.share - 0.5) < 0.2].mean())


def last_part(one: tuple[float, ...], other: tuple[float, ...], side: int) -> int:
    return int(parts(one, other)[0].place[TIPS[side]])


def test_a_body_with_a_single_pair_of_limbs_has_none() -> None:
    assert not found((20.0,), (8.0, 20.0), pairs=LimbPairs(TIPS[None], AWAY[None]))


@pytest.mark.parametrize("side", [0, 1])
def test_a_leg_has_the_joint_that_the_other_has(side: int) -> None:
    both: tuple[tuple[float, ...], ...] = ((20.0,), (8.0, 20.0))
    cuts = both if side == 0 else both[::-1]
    (joint,) = found(*cuts)
    assert (joint.part, joint.above) == (last_part(*cuts, side), False)
    assert level(joint, side) == pytest.approx(8.0, abs=0.7)
    there = V[np.abs(AWAY[side] - 8.0) < 0.7].mean(axis=0)
    np.testing.assert_allclose(joint.centre, there, atol=0.5)
    assert joint.radius == pytest.approx(RADIUS, rel=0.15)


def test_skin_blends_over_a_radius_and_all_that_is_nearer_follows_the_nearer_piece() -> None:
    (joint,) = found((20.0,), (8.0, 20.0))
    away = AWAY[0]
    assert (joint.share[away > 8.0 + 0.6 * joint.radius] == 1.0).all()
    assert (joint.share[away < 8.0 - 0.6 * joint.radius] == 0.0).all()
    assert (joint.share[away > 9.5] > 0.5).all()
    assert (joint.share[away < 6.5] < 0.5).all()


@pytest.mark.parametrize("moved", [-2.0, 3.0])
def test_a_joint_that_was_moved_along_its_limb_is_mirrored_where_it_is(moved: float) -> None:
    of, rest = parts((20.0,), (8.0, 20.0))
    inwards = -V[TIPS[1]] / np.linalg.norm(V[TIPS[1]])
    rest[of.place[TIPS[1]]] += moved * inwards
    (joint,) = mirrored_joints(V, F, of, rest, PAIRS)
    assert level(joint, 0) == pytest.approx(8.0 + moved, abs=0.8)


def test_a_joint_that_no_motion_shows_is_not_mirrored() -> None:
    of, rest = parts((20.0,), (8.0, 20.0))
    still = np.arange(len(rest)) == of.place[TIPS[1]]
    assert mirrored_joints(V, F, of, rest, PAIRS, still) == []
    assert mirrored_joints(V, F, of, rest, PAIRS, ~still)


def test_a_part_that_carries_another_is_not_divided() -> None:
    """As a hand with a thumb, which may hang on either piece."""
    of, rest = parts((20.0,), (8.0, 20.0))
    last = int(of.place[TIPS[0]])
    thumb = (np.abs(AWAY[0] - 14.0) < 2.0) & (V[:, 2] > 3.0)
    with_thumb = RootedParts(np.where(thumb, len(rest), of.place), np.append(of.parents, last), np.append(of.radius, 1.0))
    there = np.concatenate([rest, V[thumb].mean(axis=0)[None]])
    assert mirrored_joints(V, F, with_thumb, there, PAIRS) == []


def test_the_innermost_of_two_comes_first() -> None:
    (joint,) = found((24.0,), (5.0, 12.0, 24.0))
    assert level(joint, 0) == pytest.approx(12.0, abs=0.7)


def test_joints_with_partners_and_joints_above_the_last_one_are_not_added() -> None:
    assert found((8.0, 20.0), (8.0, 20.0)) == []
    assert found((5.0, 24.0), (5.0, 14.0, 24.0)) == []


def test_a_limb_without_any_joint_has_none() -> None:
    assert found((), (8.0, 20.0)) == []


def test_a_body_of_one_part_has_none() -> None:
    assert found((), ()) == []


@pytest.mark.parametrize(("wide", "is_there"), [(1.5, True), (1.7, False), (1 / 1.5, True), (1 / 1.7, False)])
def test_the_ring_must_be_about_as_wide_as_the_other_limb(wide: float, is_there: bool) -> None:
    of, rest = parts((20.0,), (8.0, 20.0))
    (joint,) = found((20.0,), (8.0, 20.0))
    radius = of.radius.copy()
    radius[of.place[TIPS[1]]] = wide * joint.radius
    assert bool(mirrored_joints(V, F, of._replace(radius=radius), rest, PAIRS)) == is_there


@pytest.mark.parametrize(("apart", "is_there"), [(3.0, True), (3.8, False), (0.0, True)])
def test_the_ring_must_lie_apart_from_the_limbs_own_joint(apart: float, is_there: bool) -> None:
    """It lies twelve from it, at a radius of 3.5."""
    assert bool(found((20.0,), (8.0, 20.0), MirroredJointsSettings(apart=apart))) == is_there


def test_a_ring_with_few_vertices_beyond_it_is_none() -> None:
    beyond = int((AWAY[0] < 8.0).sum())
    assert found((20.0,), (8.0, 20.0), MirroredJointsSettings(least_vertices=beyond - 20))
    assert not found((20.0,), (8.0, 20.0), MirroredJointsSettings(least_vertices=beyond + 20))


def test_places_that_no_path_leads_to_count_nowhere() -> None:
    away = AWAY.copy()
    island = V[:, 0] > 26.0
    away[:, island] = np.inf
    (joint,) = found((20.0,), (8.0, 20.0), pairs=LimbPairs(PAIRS.tip, np.stack([away, away])))
    assert (joint.share[island] == 1.0).all()
    assert np.isfinite(joint.centre).all()
