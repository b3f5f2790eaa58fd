"""A limb that is one part with the pelvis is cut off it at the level of the joint that its mirror image has."""

import numpy as np
import pytest
from legs import HEAD, LEAVES, LEFT, RIGHT, Legs, V, of_legs

from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs
from kinetree.tasks.numerics.structure.limbs_apart import with_limbs_apart
from kinetree.tasks.numerics.structure.limbs_in_trunk import LimbInTrunk, LimbsInTrunkSettings, limbs_in_trunk
from kinetree.tasks.numerics.structure.part_tree import joints_of, part_tree
from kinetree.tasks.numerics.structure.pruning import NO_PART, Pruned

PARTS = {"pelvis": 0, "left thigh": 0, "right thigh": 1, "left shank": 2, "right shank": 3, "chest": 4}
"""The left thigh is one part with the pelvis."""
JOINTS = {frozenset(pair) for pair in ((0, 1), (0, 5), (5, 2), (1, 3), (0, 4))}
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
    return with_limbs_apart(legs.body, state, LEAVES, confidence, 2.5)


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


def test_thigh_moves_by_itself_once_it_is_cut_off() -> None:
    legs = Legs.of(PARTS)
    left = cut(legs)
    assert left.origin.tolist() == [0, 1, 2, 3, 4, NO_PART]
    assert joints_of(left.part_tree) == JOINTS
    true = Legs.of().motion["left thigh"]
    np.testing.assert_allclose(left.parts.R[:, 5], true, atol=0.02)
    np.testing.assert_allclose(left.parts.R[:, 0], np.eye(3)[None].repeat(len(true), axis=0), atol=0.02)
    assert (left.parts.residual[:, [0, 5]] <= legs.parts.residual[:, [0]]).all()


def test_thigh_that_is_still_against_the_trunk_hangs_on_it_all_the_same() -> None:
    """And the other thigh stays where it was."""
    legs = Legs.of(PARTS, still=("left thigh",))
    left = cut(legs)
    assert joints_of(left.part_tree) == JOINTS
    assert left.part_tree.degrees.min() < 1.0


def test_thigh_is_as_certain_as_its_own_surface() -> None:
    legs, hidden = Legs.of(PARTS), np.ones((len(Legs.of().body.x), len(V)))
    hidden[::2, Legs.of().parts.label == 1] = 0.0
    share = cut(legs, hidden).parts.confidence
    assert share is not None
    assert share[::2, 5].max() < 0.15
    assert share[:, 0].min() > 0.85


def test_ends_are_those_of_the_pair() -> None:
    assert {LEFT, RIGHT, HEAD} < {*LEAVES.tolist()}
