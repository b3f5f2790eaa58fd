"""A limb that is one part with the pelvis is cut off it at the level of the joint that its mirror image has."""

import numpy as np
import pytest
from legs import LEAVES, Legs, V, of_legs
from shipped import TREE

from kinetree.tasks.numerics.structure import agreed_tree, limbs_apart
from kinetree.tasks.numerics.structure.first_tree import in_tree_order
from kinetree.tasks.numerics.structure.joint_partners import Limb
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs, limb_pairs
from kinetree.tasks.numerics.structure.limbs_apart import with_limbs_apart
from kinetree.tasks.numerics.structure.limbs_in_trunk import (
    LimbInTrunk,
    LimbsInTrunkSettings,
    _level_of_lacking,
    limbs_in_trunk,
)
from kinetree.tasks.numerics.structure.part_tree import joints_of, part_tree
from kinetree.tasks.numerics.structure.pruning import ALONE, NO_PART, Pruned, pruned_without
from kinetree.tasks.numerics.structure.tree_joints import Cut, tree_joints

PARTS = {"pelvis": 0, "left thigh": 0, "right thigh": 1, "left shank": 2, "right shank": 3, "chest": 4}
"""The left thigh is one part with the pelvis."""
HIP = frozenset((0, 5))
JOINTS = {frozenset(pair) for pair in ((0, 1), (5, 2), (1, 3), (0, 4))} | {HIP}
"""With the thigh as part 5."""


def found(
    legs: Legs, settings: LimbsInTrunkSettings | None = None, pairs: LimbPairs | None = None, paired: float = 2.5
) -> list[LimbInTrunk]:
    body, parts = legs.body, legs.parts
    tree, of = part_tree(body, parts), of_legs() if pairs is None else pairs
    return list(limbs_in_trunk(body.F, parts, tree, of, body.area, settings, paired))


def cut(legs: Legs, trust: np.ndarray | None = None) -> Pruned:
    """The parts with their limbs apart; trust (frame, vertex) 0 to 1."""
    tree = part_tree(legs.body, legs.parts)
    state = Pruned(legs.parts, tree, tree, np.arange(legs.parts.R.shape[1]), ())
    confidence = np.ones(legs.body.x.shape[:2]) if trust is None else trust
    return with_limbs_apart(legs.body, state, LEAVES, limb_pairs(V, legs.body.F, LEAVES), confidence, 2.5)


def test_thigh_is_found_at_the_level_of_the_other_hip() -> None:
    (one,) = found(Legs.of(PARTS))
    assert (one.part, one.below) == (0, 2)
    true = np.flatnonzero(Legs.of().parts.label == 1)
    both = np.intersect1d(one.limb, true)
    assert len(both) > 0.9 * max(len(one.limb), len(true))


def test_thighs_that_are_parts_are_left_alone() -> None:
    assert found(Legs.of()) == []


def test_both_thighs_may_be_one_part_with_the_trunk() -> None:
    """Nothing then says where the hips are."""
    assert found(Legs.of({**PARTS, "right thigh": 0})) == []


def test_limb_without_any_joint_is_left_alone() -> None:
    """It may hang on the trunk anywhere."""
    assert found(Legs.of({**PARTS, "left shank": 0})) == []


def test_limb_that_lacks_two_joints_is_left_alone() -> None:
    """Its foot tells nothing of the hip: another limb may be no mirror image."""
    feet = {"left foot": 5, "right foot": 6}
    assert found(Legs.of({**PARTS, **feet, "left shank": 0})) == []
    assert len(found(Legs.of({**PARTS, **feet}))) == 1


@pytest.mark.parametrize(
    ("levels", "level"), [((40, 90, 100), 90), ((40, 65, 100), None), ((70, 90, 100), None), ((40,), None)]
)
def test_of_two_joints_that_it_lacks_close_to_each_other_the_outer_one_counts(
    levels: tuple[float, ...], level: float | None
) -> None:
    """Of its mirror image, from the end; its own last joint is the partner of the first of them."""
    own = Limb(np.array([4]), np.array([float(levels[0])]))
    mirror = Limb(np.arange(len(levels)), np.array(levels, float))
    assert _level_of_lacking(own, mirror, np.array([[0, 0]]), LimbsInTrunkSettings()) == level
    assert _level_of_lacking(own, mirror, np.zeros((0, 2), np.int64), LimbsInTrunkSettings()) is None


@pytest.mark.parametrize(("inner", "count"), [(0.55, 0), (0.6, 1)])
def test_how_far_inwards_its_own_joint_may_lie(inner: float, count: int) -> None:
    """The knee lies at 0.57 of the way to the hip."""
    assert len(found(Legs.of(PARTS), LimbsInTrunkSettings(inner=inner))) == count


@pytest.mark.parametrize(("share", "count"), [(0.2, 1), (0.5, 0)])
def test_how_much_of_the_part_is_of_the_limb(share: float, count: int) -> None:
    """The thigh has two fifths of both."""
    assert len(found(Legs.of(PARTS), LimbsInTrunkSettings(share=share))) == count


def test_sides_of_few_vertices_are_none() -> None:
    (one,) = found(Legs.of(PARTS), LimbsInTrunkSettings(share=0.1))
    assert found(Legs.of(PARTS), LimbsInTrunkSettings(share=0.1, least_vertices=len(one.limb) + 1)) == []


def test_ends_that_no_path_joins_are_none() -> None:
    pairs = of_legs()
    assert found(Legs.of(PARTS), pairs=LimbPairs(pairs.tip, np.full_like(pairs.distance, np.inf))) == []


@pytest.mark.parametrize("foot", [3, 5], ids=["as many joints beyond", "a foot more on the other side"])
@pytest.mark.parametrize("side", ["left", "right"])
def test_either_leg_may_be_the_one(side: str, foot: int) -> None:
    other = {"left": "right", "right": "left"}[side]
    parts = {"pelvis": 0, f"{side} thigh": 0, f"{other} thigh": 1, f"{side} shank": 2, f"{other} shank": 3, "chest": 4}
    parts[f"{other} foot"] = foot
    (one,) = found(Legs.of(parts))
    assert (V[one.limb, 1] > 0.0).mean() == pytest.approx(1.0 if side == "left" else 0.0, abs=0.02)


def test_joints_that_are_partners_by_no_distance_tell_nothing() -> None:
    assert found(Legs.of(PARTS), paired=1e-9) == []


def test_part_without_area_is_none() -> None:
    legs = Legs.of(PARTS)
    flat = legs.body._replace(area=np.where(legs.parts.label == 0, 0.0, legs.body.area))
    assert list(limbs_in_trunk(flat.F, legs.parts, part_tree(legs.body, legs.parts), of_legs(), flat.area)) == []


def test_thigh_moves_by_itself_once_it_is_cut_off() -> None:
    legs = Legs.of(PARTS)
    left = cut(legs)
    assert left.origin.tolist() == [0, 1, 2, 3, 4, NO_PART]
    assert joints_of(left.part_tree) == JOINTS
    assert (left.parts.joined, left.parts.by_shape) == (JOINTS, {HIP})
    true = Legs.of().motion["left thigh"]
    np.testing.assert_allclose(left.parts.R[:, 5], true, atol=0.02)
    np.testing.assert_allclose(left.parts.R[:, 0], np.eye(3)[None].repeat(len(true), axis=0), atol=0.02)
    assert left.parts.residual[:, 5].max() < 0.5 * legs.parts.residual[:, 0].max()
    np.testing.assert_array_equal(left.parts.residual[:, 1:5], legs.parts.residual[:, 1:5])


def test_vertices_that_are_not_certain_do_not_turn_the_thigh() -> None:
    legs, trust = Legs.of(PARTS), np.ones((len(Legs.of().body.x), len(V)))
    thigh = np.flatnonzero(Legs.of().parts.label == 1)
    wrong = thigh[np.arange(len(thigh)) % 3 > 0]
    trust[:, wrong] = 0.0
    x = legs.body.x.copy()
    x[:, wrong] = V[wrong]
    left = cut(legs._replace(body=legs.body._replace(x=x)), trust)
    np.testing.assert_allclose(left.parts.R[:, 5], Legs.of().motion["left thigh"], atol=0.02)
    assert left.parts.residual[:, 5].max() < 0.5


@pytest.mark.parametrize("hip", [4.0, 0.0], ids=["thighs apart", "thighs that touch"])
def test_thigh_that_is_still_against_the_pelvis_hangs_on_it_all_the_same(hip: float) -> None:
    """And the other thigh stays where it was; both are parts whatever becomes of others."""
    legs = Legs.of(PARTS, still=("left thigh",), hip=hip)
    rough = legs.body.x + np.random.default_rng(0).normal(0.0, 0.3, legs.body.x.shape)
    legs = legs._replace(body=legs.body._replace(x=rough))
    left = cut(legs)
    assert joints_of(left.part_tree) == JOINTS
    assert left.part_tree.degrees.min() < 2.0
    pairs = limb_pairs(V, legs.body.F, LEAVES)
    fewer = pruned_without(legs.body, left, 4, ALONE, LEAVES, pairs, TREE.pruning)
    assert [one.part for one in fewer.dropped] == [4]
    assert fewer.parts.by_shape == {frozenset((0, 4))}


def test_limb_that_would_not_hang_on_the_pelvis_is_left_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where pelvis and thigh do not meet, or the shank and the thigh."""
    legs = Legs.of(PARTS)
    chest = np.flatnonzero(V[:, 0] > 12.0)
    monkeypatch.setattr(limbs_apart, "limbs_in_trunk", lambda *of, **more: [LimbInTrunk(4, 2, chest)])
    assert cut(legs).origin.tolist() == [0, 1, 2, 3, 4]


def test_thigh_is_as_certain_as_its_own_surface() -> None:
    legs, hidden = Legs.of(PARTS), np.ones((len(Legs.of().body.x), len(V)))
    hidden[::2, Legs.of().parts.label == 1] = 0.0
    share = cut(legs, hidden).parts.confidence
    assert share is not None
    assert share[::2, 5].max() < 0.15
    assert share[:, 0].min() > 0.85


def test_tree_of_the_cut_knows_which_joint_the_shape_alone_shows() -> None:
    """So that no other joint is kept because this one is weak."""
    legs, ones = Legs.of(PARTS, still=("left thigh",)), np.ones((len(Legs.of().body.x), len(V)))
    given = Cut(V, legs.parts.label, legs.parts.R, legs.parts.t, legs.parts.residual)
    tree = in_tree_order(tree_joints(legs.body, given, LEAVES, ones, settings=TREE), 5)
    assert len(tree.parents) == 6
    new = int(np.setdiff1d(np.arange(6), tree.place)[0])
    pairs, by_shape = agreed_tree._kept_joints(tree)
    assert len(pairs) == 5
    assert by_shape == {pair for pair in pairs if new in pair}
    assert agreed_tree._kept_joints(tree._replace(place=np.arange(6))) == (frozenset(), frozenset())
