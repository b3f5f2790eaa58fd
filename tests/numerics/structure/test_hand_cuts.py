"""Where a limb narrows a ring lies at the wrist, and none within the palm."""

import numpy as np
import pytest
from bottles import revolution

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.geodesic_distance import geodesic_distance
from kinetree.tasks.numerics.geometry.surface import Surface, surface_areas
from kinetree.tasks.numerics.structure.end_cuts import EndCut, end_cuts
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.hand_cuts import PALM, with_hand_rings
from kinetree.tasks.numerics.structure.joint_partners import RootedParts
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs
from kinetree.tasks.numerics.structure.narrowings import limb_narrowings

SHOULDER, NARROWING, END = 5.0, 15.0, 23.0
"""Heights of the joint of a limb above a trunk, of where it is narrowest, with radius 1, and of its end."""
WRIST = NARROWING + 0.75
HEIGHTS = [6.0, 10.0, 14.0, 16.0, 17.5, 18.6, 20.5]
"""Of rings that are there already."""


def bar(hand: float = 1.7) -> tuple[Floats, Ints]:
    limb = [(4.0, 3.0), (SHOULDER, 2.0), (NARROWING, 1.0), (NARROWING + 2.0, hand), (END - 1.0, hand), (END, 0.4)]
    profile = [*((-z, r) for z, r in reversed(limb)), *limb]
    return revolution([z for z, _ in profile], [r for _, r in profile])


def rings(V: Floats, F: Ints, heights: list[float] | None, times: int = 2) -> list[EndCut]:
    """The rings of both limbs: of given ones alone, or of those that every limb has, in which a hand is known then."""
    label = np.where(V[:, 2] > SHOULDER, 1, np.where(V[:, 2] < -SHOULDER, 2, 0))
    tips = np.array([len(V) - 1, len(V) - 2])
    away = geodesic_distance(Surface.of(V, F), tips)
    rest, none = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, SHOULDER], [0.0, 0.0, -SHOULDER]]), np.zeros(0)
    tree = FirstTree._make([none] * len(FirstTree._fields))._replace(
        label=label, parents=np.array([-1, 0, 0]), rest=rest, radius=np.array([0.0, 2.0, 2.0])
    )
    area = surface_areas(V, F)
    if heights is None:
        cuts = [*end_cuts(V, F, area, label, tree.parents, rest)]
    else:
        cuts = [at(V, label, part, height) for part in (1, 2) for height in heights]
    pairs = LimbPairs(np.tile(tips, (times, 1)), np.tile(away, (times, 1, 1)))
    return with_hand_rings(V, F, area, tree, cuts, pairs)


def at(V: Floats, label: Ints, part: int, height: float) -> EndCut:
    own = np.flatnonzero(label == part)
    return EndCut(part, 0, np.array([0.0, 0.0, height * (3 - 2 * part)]), 1.0, own, np.abs(V[own, 2]) - height)


def heights_of(cuts: list[EndCut], part: int) -> list[float]:
    return [abs(float(cut.centre[2])) for cut in cuts if cut.part == part]


@pytest.mark.parametrize("part", [1, 2])
def test_a_ring_lies_at_the_wrist_and_none_within_the_palm(part: int) -> None:
    """In radii of the narrowing, from where the hand begins; distances over the surface are a little longer than heights."""
    found = heights_of(rings(*bar(), HEIGHTS), part)
    assert found == sorted(found)
    kept = [h for h in HEIGHTS if h in found]
    assert kept == [6.0, 10.0, 14.0, 16.0, 20.5]
    assert [h for h in found if h not in HEIGHTS] == []


def test_without_a_ring_near_the_wrist_one_is_added_in_its_place_among_the_others() -> None:
    cuts = rings(*bar(), [6.0, 10.0, 14.0, 20.5])
    found = heights_of(cuts, 1)
    assert found == sorted(found)
    np.testing.assert_allclose(found, [6.0, 10.0, 14.0, WRIST, 20.5], atol=0.4)
    new = cuts[3]
    assert (new.part, new.above, new.hung, new.is_across_limb) == (1, 0, (), False)
    assert new.radius == pytest.approx(1.1, abs=0.2)
    assert {cut.part for cut in cuts} == {1, 2}


def test_rings_of_a_limb_that_does_not_narrow_stay() -> None:
    V, F = bar(hand=1.1)
    assert heights_of(rings(V, F, HEIGHTS), 1) == HEIGHTS


def test_a_body_with_a_single_pair_of_limbs_has_no_hands() -> None:
    assert heights_of(rings(*bar(), HEIGHTS, times=1), 1) == HEIGHTS


def test_rings_that_every_limb_has_get_one_at_the_wrist() -> None:
    V, F = bar()
    found = rings(V, F, None)
    away = [abs(h - WRIST) for h in heights_of(found, 1)]
    assert min(away) < 0.4
    low, high = PALM
    assert not any(low + 0.3 < h - WRIST < high - 0.3 for h in heights_of(found, 1))


def test_where_the_hand_begins_is_where_narrowings_have_it() -> None:
    V, F = bar()
    tips = np.array([len(V) - 1, len(V) - 2])
    away = np.tile(geodesic_distance(Surface.of(V, F), tips), (2, 1, 1))
    label = np.where(V[:, 2] > SHOULDER, 1, np.where(V[:, 2] < -SHOULDER, 2, 0))
    parts = RootedParts(label, np.array([-1, 0, 0]), np.array([0.0, 2.0, 2.0]))
    rest = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, SHOULDER], [0.0, 0.0, -SHOULDER]])
    found = list(limb_narrowings(V, F, parts, rest, LimbPairs(np.tile(tips, (2, 1)), away)))
    assert len(found) == 2
    for one, other in found:
        assert one is not None
        assert other is not None
        assert one.joint[2] == pytest.approx(WRIST, abs=0.3)
        assert other.joint[2] == pytest.approx(-WRIST, abs=0.3)
        assert one.place == pytest.approx(one.level - 0.75 * one.radius)
