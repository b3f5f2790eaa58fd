"""Flesh of the trunk that one of two thighs holds, or that both hold, goes back to the trunk."""

from collections.abc import Callable, Sequence

import numpy as np
import pytest
from fleshy_legs import OUTSIDE, flesh_of, pairs, rooted, seen, thigh
from legs import ALONG, LEGS, F, V, of_legs

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.structure import wide_borders as numerics
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.joint_partners import MirroredLimbs
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs
from kinetree.tasks.numerics.structure.rotation_centres import Borders, borders
from kinetree.tasks.numerics.structure.wide_borders import Flesh, WideBordersSettings, wide_borders


def found_in(tree: FirstTree, settings: WideBordersSettings | None = None, of: LimbPairs | None = None) -> list[Flesh]:
    return wide_borders(V, F, rooted(tree), pairs() if of is None else of, settings=settings)


@pytest.mark.parametrize("side", ["left", "right"])
def test_flesh_on_one_side_is_found(side: str) -> None:
    _, tree = seen(side)
    (one,) = found_in(tree)
    assert set(tree.label[one.vertex]) == {one.part}
    assert flesh_of(side)[one.vertex].all()
    assert len(one.vertex) > 0.4 * flesh_of(side).sum()  # the rest widens the border by less than is asked for


@pytest.mark.parametrize("sides", [(), ("left", "right")])
def test_limbs_that_are_alike_have_none(sides: Sequence[str]) -> None:
    assert found_in(seen(*sides)[1]) == []


def flares(tree: FirstTree) -> list[float]:
    """How many times as wide as that of the shank the border of each thigh is."""
    shank = {side: int(tree.label[np.argmax(ALONG[side])]) for side in LEGS}
    return [float(tree.radius[thigh(tree, side)] / tree.radius[shank[side]]) for side in LEGS]


def flared(tree: FirstTree, most: float = 0.99, least: float = 0.98) -> WideBordersSettings:
    """Borders of the thighs are this much wider than is asked for."""
    return WideBordersSettings(flared=most * max(flares(tree)), as_flared=least * min(flares(tree)))


def test_flesh_that_both_hold_is_found_where_their_borders_are_much_wider_than_the_next_ones() -> None:
    _, tree = seen("left", "right")
    both = found_in(tree, flared(tree, most=0.98 * min(flares(tree)) / max(flares(tree))))
    assert [one.part for one in both] == sorted(thigh(tree, side) for side in LEGS)
    for one in both:
        met = borders(V, F, np.isin(tree.label, _limb_from(tree, one.part)).astype(np.int64))
        lost = np.isin(np.arange(len(V)), one.vertex)
        left = borders(V, F, (np.isin(tree.label, _limb_from(tree, one.part)) & ~lost).astype(np.int64))
        assert left.radius[0] <= 0.97 * met.radius[0]
    assert found_in(tree, flared(tree, most=1.01)) == []


def _limb_from(tree: FirstTree, part: int) -> list[int]:
    """A part and those that hang on it."""
    return [part, *(below for child in np.flatnonzero(tree.parents == part) for below in _limb_from(tree, int(child)))]


def test_no_flesh_is_in_either_where_one_border_is_slim() -> None:
    _, tree = seen("left", "right")
    assert found_in(tree, flared(tree, most=0.98, least=1.01)) == []


def test_limbs_without_a_next_joint_have_no_flesh_on_both_sides() -> None:
    whole = {"pelvis": 0, "left thigh": 1, "left shank": 1, "right thigh": 2, "right shank": 2, "chest": 3}
    _, tree = seen("left", "right", parts=whole)
    assert found_in(tree, WideBordersSettings(flared=0.0, as_flared=0.0)) == []


def test_a_single_pair_of_limbs_tells_nothing() -> None:
    _, tree = seen("left")
    assert found_in(tree, of=of_legs()) == []
    assert len(found_in(tree, WideBordersSettings(least_pairs=1), of_legs())) == 1


def test_how_much_wider_the_border_is() -> None:
    _, tree = seen("left")
    ratio = tree.radius[thigh(tree, "left")] / tree.radius[thigh(tree, "right")]
    assert found_in(tree, WideBordersSettings(wider=1.01 * ratio)) == []
    assert len(found_in(tree, WideBordersSettings(wider=0.99 * ratio))) == 1


def test_it_ends_where_the_border_is_as_wide_as_the_other_one() -> None:
    _, tree = seen("left")
    lost = [len(found_in(tree, WideBordersSettings(alike=alike))[0].vertex) for alike in (1.4, 1.15, 1.05)]
    assert lost[0] < lost[1] <= lost[2]
    assert found_in(tree, WideBordersSettings(alike=0.1)) == []


def test_too_few_vertices_are_none() -> None:
    _, tree = seen("left")
    count = len(found_in(tree)[0].vertex)
    assert len(found_in(tree, WideBordersSettings(least_vertices=count))) == 1
    assert found_in(tree, WideBordersSettings(least_vertices=count + 1)) == []


def test_something_is_left_of_the_part() -> None:
    """The ring is as narrow as one likes at the end of a limb, beyond which nothing is left."""
    whole = {"pelvis": 0, "left thigh": 1, "left shank": 1, "right thigh": 2, "right shank": 2, "chest": 3}
    _, tree = seen("left", parts=whole)
    assert len(found_in(tree)) == 1
    assert len(found_in(tree, WideBordersSettings(alike=0.3, least_vertices=1))) == 1
    assert found_in(tree, WideBordersSettings(alike=0.3, least_vertices=60)) == []


def touching(*sides: str) -> FirstTree:
    """The legs with the pelvis in the thighs of these sides, half of it in each of two."""
    _, tree = seen()
    near = (tree.label == tree.parents[thigh(tree, "left")]) & (V[:, 0] < 3.0)
    of = {side: near & ((OUTSIDE[side] > 0.0) | (len(sides) < 2)) for side in sides}
    label = tree.label.copy()
    for side, own in of.items():
        label[own] = thigh(tree, side)
    return tree._replace(label=label)


@pytest.mark.parametrize("side", ["left", "right"])
def test_of_thighs_that_touch_the_one_that_begins_farther_from_its_end_holds_the_pelvis(side: str) -> None:
    tree = touching(side)
    (one,) = found_in(tree)
    assert one.part == thigh(tree, side)
    (limbs, _) = numerics.mirrored_limbs(F, rooted(tree), pairs())
    row = [*LEGS].index(side)
    levels = [limb.level[-1] for limb in (limbs.one, limbs.other)]
    away = of_legs().distance[0, row]
    assert levels[row] == max(levels)
    assert away[one.vertex].min() > np.mean(levels)
    lost = [len(found_in(tree, WideBordersSettings(of_way=way))[0].vertex) for way in (0.2, 0.5, 1.0)]
    assert lost[0] < lost[1] < lost[2]


def test_how_much_farther_it_begins() -> None:
    tree = touching("left")
    (limbs, _) = numerics.mirrored_limbs(F, rooted(tree), pairs())
    least = min(float(tree.radius[limb.part[-1]]) for limb in (limbs.one, limbs.other))
    deeper = abs(limbs.one.level[-1] - limbs.other.level[-1]) / least
    assert len(found_in(tree, WideBordersSettings(deeper=0.99 * deeper))) == 1
    assert found_in(tree, WideBordersSettings(deeper=1.01 * deeper)) == []


def test_thighs_that_touch_and_begin_alike_have_none() -> None:
    assert found_in(touching("left", "right")) == []


def test_of_a_thigh_that_touches_the_other_a_wide_border_says_nothing() -> None:
    """Either may hold the pelvis."""
    assert found_in(touching("left"), WideBordersSettings(wider=0.0, deeper=np.inf)) == []


@pytest.mark.parametrize(("radius", "lowest"), [(2.0, 0.0), (6.0, 0.0), (99.0, np.inf)])
def test_flesh_ends_a_radius_before_the_next_joint(radius: float, lowest: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """An oblique ring there is on the part in no more than a piece, which is as narrow as one likes."""
    _, tree = seen("left")
    (limbs, _) = numerics.mirrored_limbs(F, rooted(tree), pairs())
    away, tried = of_legs().distance[0, 0], [np.inf]
    is_own = tree.label == thigh(tree, "left")

    def tried_with(_V: Floats, _F: Ints, is_limb: Ints) -> Borders:
        tried.append(float(away[is_own & (is_limb > 0)].max()))
        met = borders(_V, _F, is_limb)
        return met._replace(radius=np.full_like(met.radius, np.inf))

    monkeypatch.setattr(numerics, "borders", tried_with)
    assert len(numerics._flesh(V, F, rooted(tree), limbs.one, away, radius, WideBordersSettings())) == 0
    least = float(limbs.one.level[-2]) + radius
    assert min(tried) >= max(least - 1.0, lowest)
    assert (min(tried) < least + 1.0) == (lowest == 0.0)


def test_flesh_hangs_together_with_the_trunk() -> None:
    """What lies apart from it on the limb's part is none of its flesh."""
    _, tree = seen("left")
    left = thigh(tree, "left")
    assert tree.label[np.argmax(V[:, 0])] != tree.parents[left]
    far = (V[:, 0] > 20.0) & (V[:, 1] > 0.0)
    sleeve = rooted(tree._replace(label=np.where(far, left, tree.label)))
    assert wide_borders(V, F, sleeve, pairs(), np.inf) == []


def test_part_that_no_path_reaches_has_none() -> None:
    _, tree = seen("left")
    (limbs, _) = numerics.mirrored_limbs(F, rooted(tree), pairs())
    away = np.full(len(V), np.inf)
    for limb in (limbs.one, limbs.one._replace(part=limbs.one.part[-1:], level=limbs.one.level[-1:])):
        assert len(numerics._flesh(V, F, rooted(tree), limb, away, 4.0, WideBordersSettings())) == 0


def test_partners_are_those_of_the_tree(monkeypatch: pytest.MonkeyPatch) -> None:
    _, tree = seen("left")
    given: list[float] = []
    real = numerics.mirrored_limbs
    monkeypatch.setattr(numerics, "mirrored_limbs", lambda *of: given.append(of[-1]) or real(*of))
    wide_borders(V, F, rooted(tree), pairs(), 1.75)
    assert given == [1.75]


@pytest.mark.parametrize(
    "changed",
    [
        lambda limbs: limbs._replace(row=limbs.row[:1]),
        lambda limbs: limbs._replace(row=np.array([[0, 1], [1, 0]])),
        lambda limbs: limbs._replace(one=limbs.one._replace(part=limbs.one.part[[0, 0, 1]], level=limbs.one.level[[0, 0, 1]])),
        lambda limbs: limbs._replace(other=limbs.other._replace(part=limbs.other.part[[0, 1, 1]])),
        lambda limbs: limbs._replace(
            one=limbs.one._replace(part=limbs.one.part[:0]),
            other=limbs.other._replace(part=limbs.other.part[:0]),
            row=limbs.row[:0],
        ),
    ],
)
def test_all_joints_are_partners(changed: Callable[[MirroredLimbs], MirroredLimbs], monkeypatch: pytest.MonkeyPatch) -> None:
    _, tree = seen("left")
    real = numerics.mirrored_limbs
    monkeypatch.setattr(numerics, "mirrored_limbs", lambda *of: [changed(limbs) for limbs in real(*of)])
    assert found_in(tree) == []


def test_limb_that_carries_another_one_has_none() -> None:
    _, tree = seen("left")
    (one,) = found_in(tree)
    chest = int(tree.label[np.argmax(V[:, 0])])
    assert found_in(tree._replace(parents=np.where(np.arange(len(tree.parents)) == chest, one.part, tree.parents))) == []
