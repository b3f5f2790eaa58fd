"""Flesh between the trunk and limbs of a pair, which follows both, is no bone, on both sides or on one."""

from collections.abc import Callable, Sequence

import numpy as np
import pytest
from legs import ALONG, FRAMES, LEAVES, LEGS, F, V, of_legs
from limbs import rotation
from shipped import TREE

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.geometry.surface import surface_areas
from kinetree.tasks.numerics.structure import agreed_tree
from kinetree.tasks.numerics.structure import mirrored_slices as numerics
from kinetree.tasks.numerics.structure.first_tree import FirstTree, in_tree_order
from kinetree.tasks.numerics.structure.joint_partners import PAIRED, Limb, MirroredLimbs, RootedParts
from kinetree.tasks.numerics.structure.mirrored_slices import (
    MirroredSlicesSettings,
    Slice,
    SliceLimits,
    mirrored_slices,
)
from kinetree.tasks.numerics.structure.part_motion import fit, residuals
from kinetree.tasks.numerics.structure.part_tree import MovingParts, MovingSurface, part_tree
from kinetree.tasks.numerics.structure.pruning import FLESH, Pruned
from kinetree.tasks.numerics.structure.tree_joints import TreeJoints, tree_of_parts

HIP = 8.0
"""Distance of the joint from the fork; flesh about it is a part from `INNER` to `OUTER`."""
INNER, OUTER, KNEE = 4.0, 12.0, 20.0
ONES = np.ones((FRAMES, len(V)))
EVENLY = TREE._replace(across=TREE.spread, along=TREE.spread)
"""Joints that are held alike along a thigh and across it: both joints of the flesh stay well apart."""


def seen(
    is_flesh: bool = True,
    outer: Sequence[float] = (OUTER, OUTER),
    flesh_of: Sequence[str] = ("left", "right"),
    bone_of: Sequence[str] = (),
    limb_of: Sequence[str] = (),
    inner: float = INNER,
) -> tuple[MovingSurface, FirstTree]:
    """Legs whose thighs turn about the hips. What lies about a hip is a mixture of both, or a bone that turns half as far.

    flesh_of, limb_of : the sides on which it is a part of its own, or one with the thigh; else it is one with the trunk
    """
    label, x = np.zeros(len(V), np.int64), np.tile(V, (FRAMES, 1, 1))
    for k, (side, leg) in enumerate(LEGS.items()):
        s, end = ALONG[side], outer[k]
        thigh, half, shank = (_swings(degrees, k, phase) for degrees, phase in ((40.0, 0), (20.0, 0), (30.0, 3)))
        hip, knee = HIP * leg, KNEE * leg
        moved = hip + (V - hip) @ thigh.transpose(0, 2, 1)
        lower = (hip + (knee - hip) @ thigh.transpose(0, 2, 1))[:, None] + (V - knee) @ (thigh @ shank).transpose(0, 2, 1)
        share = np.clip((s - INNER) / (end - INNER), 0.0, 1.0)[None, :, None]
        about = (
            (1.0 - share) * V + share * moved if is_flesh and side not in bone_of else hip + (V - hip) @ half.transpose(0, 2, 1)
        )
        for number, low, high, there in ((1, inner, end, about), (3, end, KNEE, moved), (5, KNEE, np.inf, lower)):
            own = (s > low) & (s <= high)
            flesh = 1 + k if side in flesh_of else 3 + k if side in limb_of else 0
            label[own], x[:, own] = number + k if number > 1 else flesh, there[:, own]
    label = np.unique(label, return_inverse=True)[1].reshape(-1)
    count, area, weight = int(label.max()) + 1, surface_areas(V, F), np.asfortranarray(ONES)
    R, t = np.empty((FRAMES, count, 3, 3)), np.empty((FRAMES, count, 3))
    fit(V, x, weight, area, label, np.ones(count, np.bool_), False, len(V), 1e-6, R, t)
    left = np.maximum(residuals(V, x, weight * area, R, t, label), 0.01)
    body, parts = MovingSurface(V, F, x, area), MovingParts(label, R, t, left, np.ones((FRAMES, count)))
    found = part_tree(body, parts)
    start = Pruned(parts, found, found, np.arange(count), ())
    return body, in_tree_order(tree_of_parts(body, start, np.arange(count), label, ONES, EVENLY), count)


def _swings(degrees: float, side: int, phase: int) -> Floats:
    """(frame, 3, 3) of one leg."""
    angle = np.radians(degrees) * np.sin(np.arange(FRAMES) + side + phase)
    return np.array([rotation((0.3, 0.3, 1.0), a) for a in angle])


def found_in(seen_as: tuple[MovingSurface, FirstTree], settings: MirroredSlicesSettings | None = None) -> list[Slice]:
    return mirrored_slices(*seen_as, of_legs(), ONES, PAIRED, settings)


def test_flesh_on_both_sides_is_found() -> None:
    body, tree = seen()
    slices = found_in((body, tree))
    assert len(slices) == 2
    for one in slices:
        assert tree.parents[[one.part, *one.below]].tolist() == [one.above, one.part]
        along = np.maximum(ALONG["left"], ALONG["right"])[tree.label == one.part]
        assert INNER <= along.min() < along.max() <= OUTER


def limits(
    length: float = 2.2, alike: float = 1.5, mixture: float = 3.6, least: float = 1.2, alone: float = 1.8
) -> MirroredSlicesSettings:
    """Of parts that do not touch each other, as here; parts that do are none."""
    apart, none = SliceLimits(least, length, alike, mixture), SliceLimits(0.0, 0.0, 0.0, 0.0)
    return MirroredSlicesSettings(apart=apart, touching=none, least_alone=alone)


ALONE = MirroredSlicesSettings(least_alone=1.2)
"""The flesh here is 1.5 radii long, so that on one side alone it would be for others to judge."""
ANY_LENGTH = limits(alike=np.inf, least=0.0)


def test_bones_that_turn_by_themselves_are_none() -> None:
    assert found_in(seen(is_flesh=False), ANY_LENGTH) == []


@pytest.mark.parametrize("side", ["left", "right"])
def test_flesh_on_one_side_is_one_if_the_other_has_one_long_bone_there(side: str) -> None:
    other = {"left": "right", "right": "left"}[side]
    body, tree = seen(flesh_of=(side,), limb_of=(other,))
    assert found_in((body, tree), MirroredSlicesSettings(least_alone=1.8)) == []
    (one,) = found_in((body, tree), ALONE)
    along = ALONG[side][tree.label == one.part]
    assert INNER <= along.min() < along.max() <= OUTER
    assert found_in((body, tree), ALONE._replace(longer=9.0)) == []
    assert found_in((body, tree), limits(length=0.9, alone=0.0)) == []
    bone = seen(is_flesh=False, flesh_of=(side,), limb_of=(other,))
    assert len(found_in(bone, limits(least=0.0, mixture=np.inf, alone=0.0))) == 1
    assert found_in(bone, limits(least=0.0, alone=0.0)) == []


@pytest.mark.parametrize("side", ["left", "right"])
def test_flesh_opposite_to_a_bone_of_its_length_is_none(side: str) -> None:
    other = {"left": "right", "right": "left"}[side]
    assert found_in(seen(bone_of=(other,)), ANY_LENGTH) == []


@pytest.mark.parametrize(
    ("own", "others", "count"), [((0, 1, 2), (0, 1, 0), 0), ((), (), 0), ((0, 1), (0, 1), 1), ((0, 2), (0, 1), 1)]
)
def test_of_the_two_joints_of_flesh_on_one_side_one_has_a_partner(
    own: Sequence[int], others: Sequence[int], count: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    row = np.array([own, others], np.int64).T
    assert len(found_with(lambda limbs: limbs._replace(row=row), monkeypatch)) == count


@pytest.mark.parametrize("parts", [0, 1])
def test_flesh_opposite_to_a_limb_of_a_part_or_none_is_none(parts: int, monkeypatch: pytest.MonkeyPatch) -> None:
    def shorter(limbs: MirroredLimbs) -> MirroredLimbs:
        return limbs._replace(other=Limb(limbs.other.part[:parts], limbs.other.level[:parts]))

    assert found_with(shorter, monkeypatch) == []


def found_with(changed: Callable[[MirroredLimbs], MirroredLimbs], monkeypatch: pytest.MonkeyPatch) -> list[Slice]:
    """With flesh on the left alone, as if limbs were others."""
    body, tree = seen(flesh_of=("left",), limb_of=("right",))
    real = numerics.mirrored_limbs
    monkeypatch.setattr(numerics, "mirrored_limbs", lambda *of: [changed(limbs) for limbs in real(*of)])
    return found_in((body, tree), ALONE)


@pytest.mark.parametrize(
    ("lengths", "mixtures", "inner", "count"),
    [
        ((3.8, 2.0), (5.1, 5.1), INNER, 2),
        ((4.0, 2.0), (5.1, 5.1), INNER, 1),
        ((4.0, 3.95), (5.1, 5.1), INNER, 0),
        ((3.8, 2.0), (5.3, 5.1), INNER, 1),
        ((3.8, 2.0), (5.1, 5.3), INNER, 0),
        ((3.8, 1.45), (5.1, 5.1), INNER, 0),
        ((9.0, 1.9), (5.1, 5.1), INNER, 1),
        ((9.0, 1.55), (5.1, 5.1), INNER, 1),
        ((9.0, 1.45), (5.1, 5.1), INNER, 0),
        ((9.0, 0.6), (2.9, 2.9), INNER, 0),
        ((9.0, 0.5), (2.9, 2.9), INNER, 1),
        ((9.0, 0.5), (3.1, 3.1), INNER, 0),
        ((9.0, 0.5), (2.9, 2.9), 0.0, 1),
        ((2.5, 1.7), (5.3, 5.1), INNER, 0),
        ((1.1, 1.0), (5.1, 5.1), INNER, 2),
        ((0.45, 0.45), (5.1, 5.1), INNER, 0),
        ((0.55, 0.55), (5.1, 5.1), INNER, 2),
        ((1.1, 1.0), (3.5, 3.5), 0.0, 0),
        ((2.1, 1.5), (3.5, 3.5), 0.0, 2),
        ((2.1, 1.5), (3.7, 3.5), 0.0, 0),
        ((2.3, 1.6), (3.5, 3.5), 0.0, 0),
        ((2.1, 1.3), (3.5, 3.5), 0.0, 0),
        ((1.1, 0.7), (3.5, 3.5), 0.0, 2),
        ((1.1, 0.1), (3.5, 3.5), 0.0, 2),
        ((1.1, 0.85), (3.5, 3.5), 0.0, 0),
        ((1.45, 0.9), (3.5, 3.5), 0.0, 2),
        ((1.55, 1.0), (3.5, 3.5), 0.0, 0),
        ((1.1, 0.7), (3.7, 3.5), 0.0, 0),
    ],
)
def test_limits(
    lengths: tuple[float, float],
    mixtures: tuple[float, float],
    inner: float,
    count: int,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of the part on the right, which is one with the thigh, and of that on the left; they touch if they begin at the fork,
    and do not move as two.
    """
    body, tree = seen(flesh_of=("left",), limb_of=("right",), inner=inner)
    right = int(tree.label[np.argmin(np.where(tree.label > 0, np.abs(ALONG["right"] - OUTER), np.inf))])
    monkeypatch.setattr(numerics, "_left_by_one", lambda *of: 2.0)
    monkeypatch.setattr(numerics, "_length", lambda _, limb: lengths[int(limb.part[-1] != right)])
    monkeypatch.setattr(numerics, "_mixture", lambda _body, _tree, one, _trust: mixtures[int(one.part != right)])
    assert len(found_in((body, tree))) == count


def test_length_is_in_radii_of_the_smaller_border_of_a_part_that_carries_one() -> None:
    _, tree = seen()
    (part,) = np.flatnonzero(tree.parents == 0)[:1]
    (below,) = np.flatnonzero(tree.parents == part)
    limb = Limb(np.array([below, part]), np.ones(2))
    apart = np.linalg.norm(tree.rest[part] - tree.rest[below])
    for radii in ((2.0, 5.0), (5.0, 2.0)):
        radius = tree.radius.copy()
        radius[[part, below]] = radii
        assert numerics._length(tree._replace(radius=radius), limb) == pytest.approx(apart / 2.0)
    forked = tree.parents.copy()
    forked[np.flatnonzero(tree.parents == 0)[1]] = part
    assert numerics._length(tree._replace(parents=forked), limb) == np.inf
    assert numerics._length(tree, Limb(limb.part[:1], limb.level[:1])) == np.inf


def test_frames_in_which_vertices_are_not_certain_do_not_count() -> None:
    body, tree = seen(is_flesh=False)
    x, trust = body.x.copy(), ONES.copy()
    x[::2] += np.random.default_rng(0).normal(0.0, 5.0, x[::2].shape)
    trust[::2] = 0.0
    assert mirrored_slices(body._replace(x=x), tree, of_legs(), trust, PAIRED, ANY_LENGTH) == []


@pytest.mark.parametrize(("least", "most", "count"), [(0.5, 2.2, 2), (0.5, 0.9, 0), (1.8, 2.2, 0)])
def test_how_long_they_may_be(least: float, most: float, count: int) -> None:
    """These are 1.3 radii long; links from a pelvis to its hips are shorter."""
    assert len(found_in(seen(), limits(length=most, least=least))) == count


def test_how_little_of_a_mixture_they_may_be() -> None:
    assert len(found_in(seen(is_flesh=False), limits(alike=np.inf, least=0.0, mixture=np.inf))) == 2


@pytest.mark.parametrize(("alike", "count"), [(1.2, 0), (9.0, 2)])
def test_both_are_as_long(alike: float, count: int) -> None:
    uneven = seen(outer=(OUTER + 3.0, OUTER))
    assert len(found_in(uneven, limits(length=9.0, alike=alike))) == count


def test_parts_that_touch_each_other_have_limits_of_their_own() -> None:
    """Flesh from the fork on: both halves meet there."""
    touching, apart = seen(inner=0.0), seen()
    wide, none = SliceLimits(0.0, 99.0, 99.0, 99.0), SliceLimits(0.0, 0.0, 0.0, 0.0)
    for beside, away, counts in ((wide, none, (2, 0)), (none, wide, (0, 2))):
        settings = MirroredSlicesSettings(touching=beside, apart=away, longer_of_unequal=np.inf)
        assert tuple(len(found_in(there, settings)) for there in (touching, apart)) == counts


def test_slices_on_one_side_that_touch_the_other_limb_are_none() -> None:
    lone = SliceLimits(0.0, 99.0, 1.0, 99.0)
    settings = MirroredSlicesSettings(touching=lone, apart=lone, least_alone=0.0, longer=1.0)
    counts = [len(found_in(seen(flesh_of=("left",), limb_of=("right",), inner=inner), settings)) for inner in (0.0, INNER)]
    assert counts == [0, 1]


def test_a_bone_that_is_nowhere_certain_is_none() -> None:
    body, tree = seen(is_flesh=False)
    trust = ONES.copy()
    trust[:, np.isin(tree.label, np.flatnonzero(tree.parents == 0))] = 0.0
    assert mirrored_slices(body, tree, of_legs(), trust, PAIRED, ANY_LENGTH) == []


def test_a_slice_opposite_to_a_bone_that_is_hardly_longer_is_one_all_the_same() -> None:
    """Both are short enough for a pair, but one is no mixture."""
    there = seen(flesh_of=("left",), limb_of=("right",))
    assert len(found_in(there, ALONE._replace(apart=SliceLimits(0.0, 9.0, 3.0, 5.2)))) == 1


def test_how_far_inwards_a_vertex_lies() -> None:
    body, tree = seen()
    for one in found_in((body, tree)):
        inner, outer = tree.rest[[one.part, *one.below]]
        ratio = np.linalg.norm(V - outer, axis=1) / np.linalg.norm(V - inner, axis=1)
        is_before = (V - inner) @ (outer - inner) <= 0.0
        np.testing.assert_allclose(one.inwards, np.where(is_before, np.inf, ratio))
        assert is_before.any()


def test_a_vertex_on_the_inner_joint_lies_innermost() -> None:
    body, tree = seen()
    rest = tree.rest.copy()
    (one, _) = found_in((body, tree))
    rest[one.part] = V[np.linalg.norm(V - rest[one.part], axis=1).argmin()]
    assert np.isinf(found_in((body, tree._replace(rest=rest)))[0].inwards[np.linalg.norm(V - rest[one.part], axis=1).argmin()])


UNEVEN = (OUTER, OUTER - 3.0)
"""Flesh reaches farther on the left, so that other shares of it go to the limb."""


def error(joints: TreeJoints | FirstTree) -> float:
    """Sum of the distances of both hips from the joints nearest to them, mesh unit."""
    return sum(float(np.linalg.norm(joints.rest - HIP * leg, axis=1).min()) for leg in LEGS.values())


@pytest.mark.parametrize(("looser", "chosen"), [(None, (1.0, 0.7)), (1.3, (1.0, 0.7)), (3.0, (1.0, 0.3)), (99.0, (0.3, 0.3))])
def test_slices_are_shared_out_where_the_joint_no_longer_drifts(
    looser: float | None, chosen: tuple[float, float], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each side as its own joint wants it."""
    body, tree = seen(outer=UNEVEN)
    settings = MirroredSlicesSettings() if looser is None else MirroredSlicesSettings(looser=looser)
    monkeypatch.setattr(agreed_tree, "MirroredSlicesSettings", lambda: settings)
    slices = found_in((body, tree))
    assert [bool(ALONG["left"][tree.label == one.part].mean() > 0.0) for one in slices] == [True, False]
    made = agreed_tree._without_slices(body, tree, found_in((body, tree)), ONES, TREE)
    want = agreed_tree._joints_without(body, tree, agreed_tree._pruned(body, tree), slices, chosen, ONES, TREE)
    np.testing.assert_array_equal(made.label, want.label)


def test_joint_lies_nearer_so_than_with_one_share_for_all() -> None:
    body, tree = seen(outer=UNEVEN)
    slices, start = found_in((body, tree)), agreed_tree._pruned(body, tree)
    made = agreed_tree._without_slices(body, tree, found_in((body, tree)), ONES, TREE)
    for share in (0.3, 1.4):
        assert error(made) < error(agreed_tree._joints_without(body, tree, start, slices, [share, share], ONES, TREE))


def test_joints_that_are_to_stay_are_those_of_the_neighbours_then() -> None:
    """As where a limb was cut off: all borders of the tree cost nothing, so the next one must not cost."""
    body, tree = seen()
    cut_off = tree._replace(place=np.where(np.arange(len(tree.place)) == len(tree.place) - 1, -1, tree.place))
    start = agreed_tree._pruned(body, cut_off)
    slices = found_in((body, tree))
    joints = agreed_tree._joints_without(body, tree, start, slices, [0.5, 0.5], ONES, TREE)
    assert len(start.parts.joined) == len(tree.parents) - 1
    origin = joints.left.origin
    pairs = {frozenset(int(origin[part]) for part in pair) for pair in joints.left.parts.joined}
    assert {frozenset((one.above, *one.below)) for one in slices} <= pairs
    assert len(pairs) == len(tree.parents) - 3


def test_tree_without_them_has_one_joint_a_side_near_the_hip() -> None:
    body, tree = seen()
    left = agreed_tree._without_slices(body, tree, found_in((body, tree)), ONES, TREE)
    assert len(left.parents) == len(tree.parents) - 2
    assert [one.reason for one in left.graph.dropped] == [FLESH, FLESH]
    assert (left.place < 0).sum() == 2
    hips = left.rest[np.flatnonzero(left.parents == 0)]
    for leg in LEGS.values():
        assert np.linalg.norm(hips - HIP * leg, axis=1).min() < 1.5
    assert {*left.label[LEAVES].tolist()} <= {*range(len(left.parents))}


def test_agreed_tree_has_none_where_vertices_were_aligned() -> None:
    body, tree = seen()
    aligned = agreed_tree.agreed_tree(body, [tree], LEAVES, ONES, settings=TREE).tree
    followed = agreed_tree.agreed_tree(body, [tree], LEAVES, None, settings=TREE).tree
    assert (len(aligned.parents), len(followed.parents)) == (len(tree.parents) - 2, len(tree.parents))
    slices = np.isin(tree.label, [one.part for one in found_in((body, tree))])
    assert 0.3 < (aligned.label[slices] == 0).mean() < 0.7


@pytest.mark.parametrize(("most_drift", "gone"), [(0.7, 2), (0.0, 0), (np.inf, 2)])
def test_a_part_without_which_the_limb_drifts_far_stays(most_drift: float, gone: int) -> None:
    body, tree = seen()
    left = agreed_tree._without_slices(body, tree, found_in((body, tree)), ONES, TREE, most_drift)
    assert len(left.parents) == len(tree.parents) - gone
    assert (left is tree) == (gone == 0)


def test_each_part_is_judged_by_its_own_joint(monkeypatch: pytest.MonkeyPatch) -> None:
    """With both gone one joint drifts far; the other goes by itself then."""
    body, tree = seen()
    slices = found_in((body, tree))
    far = frozenset((slices[0].above, *slices[0].below))
    between = agreed_tree._between
    monkeypatch.setattr(agreed_tree, "_between", lambda *of: {k: 9.0 if k == far else v for k, v in between(*of).items()})
    left = agreed_tree._without_slices(body, tree, slices, ONES, TREE, 0.7)
    assert len(left.parents) == len(tree.parents) - 1
    assert left.place[slices[0].part] >= 0
    assert left.place[slices[1].part] < 0


def test_tree_without_slices_stays_as_it_is() -> None:
    body, tree = seen(is_flesh=False)
    assert agreed_tree._without_slices(body, tree, found_in((body, tree)), ONES, TREE) is tree


@pytest.mark.parametrize(
    ("thigh", "flesh", "mixture", "count"),
    [
        (0.5, 2.7, 9.9, 2),
        (0.6, 2.7, 9.9, 0),
        (2.5, 2.7, 2.9, 2),
        (2.7, 2.7, 2.9, 0),
        (2.5, 2.5, 2.9, 0),
        (2.5, 2.7, 3.1, 0),
        (2.5, np.inf, 2.9, 2),
    ],
)
def test_slices_farther_out_lie_beside_long_parts(
    thigh: float, flesh: float, mixture: float, count: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The thigh as a slice between the flesh about the hip and the shank."""
    body, tree = seen()
    lengths = {int(k): flesh if tree.parents[k] == 0 else thigh for k in range(1, len(tree.parents))}
    monkeypatch.setattr(numerics, "_radii_long", lambda tree, below, part: lengths[part])
    monkeypatch.setattr(numerics, "_mixture", lambda *of: mixture)
    slices = found_in((body, tree), limits(length=0.0))
    assert len(slices) == count
    for one in slices:
        assert tree.parents[[*one.below, one.part, one.above]].tolist() == [one.part, one.above, 0]


def test_beside_a_slice_at_the_trunk_none_lies_farther_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """The flesh is longer than a slice farther out may be, but not than one at the trunk."""
    body, tree = seen()
    monkeypatch.setattr(numerics, "_radii_long", lambda tree, below, part: 3.0 if tree.parents[part] == 0 else 1.0)
    monkeypatch.setattr(numerics, "_mixture", lambda *of: 1.0)
    assert [tree.parents[one.part] for one in found_in((body, tree))] == [0, 0]
    left = agreed_tree._without_slices(body, tree, found_in((body, tree)), ONES, TREE)
    assert len(left.parents) == len(tree.parents) - 2


def test_a_slice_farther_out_is_shared_out_as_others_are(monkeypatch: pytest.MonkeyPatch) -> None:
    body, tree = seen()
    monkeypatch.setattr(numerics, "_radii_long", lambda tree, below, part: 9.0 if tree.parents[part] == 0 else 1.0)
    monkeypatch.setattr(numerics, "_mixture", lambda *of: 1.0)
    left = agreed_tree._without_slices(body, tree, found_in((body, tree)), ONES, TREE)
    assert len(left.parents) == len(tree.parents) - 2
    np.testing.assert_array_equal(left.place < 0, tree.parents[tree.parents] == 0)


def of_halves(together: float) -> tuple[MovingSurface, FirstTree]:
    """Parts from the fork on that turn by themselves, or by such a share move as one."""
    body, tree = seen(is_flesh=False, inner=0.0)
    x, halves = body.x.copy(), np.isin(tree.label, np.flatnonzero(tree.parents == 0))
    x[:, halves] = together * V[halves] + (1.0 - together) * x[:, halves]
    return body._replace(x=x), tree


def left_by_one(body: MovingSurface, tree: FirstTree, trust: Floats = ONES) -> float:
    (limbs,) = numerics.mirrored_limbs(F, RootedParts(tree.label, tree.parents, tree.radius), of_legs(), PAIRED)
    return numerics._left_by_one(body, tree, limbs, trust)


def test_how_much_halves_move_as_one() -> None:
    left = [left_by_one(*of_halves(together)) for together in (0.0, 0.9, 1.0)]
    assert left[0] > 2.5
    assert left[1] > 1.5
    assert left[2] == 1.0


def test_what_is_left_of_halves_that_are_rigid_is_none() -> None:
    """By rounding one of two motions that leave nothing may leave any number of times as much."""
    body, tree = of_halves(1.0)
    noisy = body.x + 1e-9 * np.random.default_rng(0).normal(size=body.x.shape)
    assert left_by_one(body._replace(x=noisy), tree) == 1.0


@pytest.mark.parametrize(
    ("left", "lengths", "counts"),
    [
        (2.05, (0.6, 1.1), (0, 0, 2)),
        (2.05, (1.0, 1.1), (0, 2, 0)),
        (2.05, (0.6, 1.3), (0, 2, 0)),
        (2.15, (0.6, 1.1), (2, 0, 0)),
        (2.15, (1.0, 1.1), (2, 0, 0)),
    ],
)
def test_halves_have_limits_by_whether_they_move_as_two_and_are_as_long(
    left: float, lengths: tuple[float, float], counts: Sequence[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Those that are as long as each other and do not move as two may be links from a pelvis to hips."""
    body, tree = of_halves(0.0)
    first = int(np.flatnonzero(tree.parents == 0)[0])
    monkeypatch.setattr(numerics, "_left_by_one", lambda *of: left)
    monkeypatch.setattr(numerics, "_length", lambda _, limb: lengths[int(limb.part[-1] == first)])
    wide, short, none = (SliceLimits(0.0, length, 9.0, np.inf) for length in (9.0, 1.2, 0.0))
    nothing = MirroredSlicesSettings(touching=none, apart=none, opposed=none, unequal=short._replace(mixture=0.0))
    for kind, limits, count in zip(("opposed", "touching", "unequal"), (wide, wide, short), counts, strict=True):
        assert len(found_in((body, tree), nothing._replace(**{kind: limits}))) == count


def test_uncertain_vertices_do_not_say_that_halves_move_as_two() -> None:
    body, tree = of_halves(1.0)
    x, trust = body.x.copy(), ONES.copy()
    x[::2] += np.random.default_rng(0).normal(0.0, 5.0, x[::2].shape)
    trust[::2] = 0.0
    assert left_by_one(body._replace(x=x), tree, trust) < 1.5
