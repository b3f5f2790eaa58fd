"""Slabs beside hidden bones go, where the bone explains the body as well without them."""

import numpy as np
import pytest
from articulated import ALL_STAY, Known, and_at_rest, chain, cut_by_height, surface, swings

from kinetree.tasks.numerics.structure.inserted_bones import inserted_bones
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.pruning import NO_PART
from kinetree.tasks.numerics.structure.slabs import SlabsSettings, bones_without_slabs
from kinetree.tasks.numerics.structure.tree_joints import TreeJoints


def soft_neck() -> Known:
    """A tube of three parts, the middle one short and under soft skin, with joints at −0.9 and 0.9."""
    return chain((-0.9, 0.9), swings(24, 3, 20.0, seed=3), blend=2.4, along=60)


def in_takes(body: Known) -> MovingSurface:
    """Its surface, seen in two takes."""
    return surface(body)._replace(takes=[slice(0, 12), slice(12, 24)])


def cut_amiss() -> TreeJoints:
    """Its cut, with a slab of the soft skin as its second part."""
    return cut_by_height(soft_neck(), (0.0, 1.7))


def origins(joints: TreeJoints) -> list[int]:
    return joints.left.origin[joints.left.part_tree.tree.order].tolist()


def test_a_hidden_bone_takes_the_place_of_the_slab_beside_it() -> None:
    body, before = in_takes(soft_neck()), cut_amiss()
    with_slab = inserted_bones(body, before, ALL_STAY.noise * body.size)
    after = bones_without_slabs(body, before, ALL_STAY)
    assert origins(with_slab) == [0, NO_PART, 1, 2]
    assert origins(after) == [0, NO_PART, 2]
    assert [part.reason for part in after.left.dropped] == ["flesh"]
    assert abs(after.rest[2, 2] - 0.9) < 0.5 * abs(with_slab.rest[3, 2] - 0.9)
    assert set(after.label) == {0, 1, 2}


@pytest.mark.parametrize("strict", [{"length": 0.1}, {"worse": 0.1, "one_point": 0.0}])
def test_a_part_stays_whose_joints_lie_apart_or_without_which_the_bone_drifts(strict: dict[str, float]) -> None:
    body, before = in_takes(soft_neck()), cut_amiss()
    with_slab = inserted_bones(body, before, ALL_STAY.noise * body.size)
    after = bones_without_slabs(body, before, ALL_STAY, SlabsSettings(**strict))
    assert origins(after) == origins(with_slab)
    np.testing.assert_array_equal(after.rest, with_slab.rest)


def test_joints_that_lie_as_one_are_one_however_much_the_bone_drifts() -> None:
    body, before = in_takes(soft_neck()), cut_amiss()
    assert origins(bones_without_slabs(body, before, ALL_STAY, SlabsSettings(worse=0.1, one_point=0.9))) == [0, NO_PART, 2]


@pytest.mark.parametrize(("worse", "left"), [(0.7, [0, NO_PART, 1, 2]), (0.8, [0, NO_PART, 2])])
def test_takes_in_which_the_body_rests_change_nothing(worse: float, left: list[int]) -> None:
    resting, takes = and_at_rest(soft_neck(), 24)
    limits = SlabsSettings(worse=worse, one_point=0.0)
    after = bones_without_slabs(surface(resting)._replace(takes=takes), cut_by_height(resting, (0.0, 1.7)), ALL_STAY, limits)
    moving = bones_without_slabs(in_takes(soft_neck()), cut_amiss(), ALL_STAY, limits)
    assert origins(after) == origins(moving) == left


def test_a_part_whose_joints_lie_as_far_apart_as_a_bones_stays() -> None:
    body, before = in_takes(soft_neck()), cut_by_height(soft_neck(), (0.0, 2.8))
    assert origins(bones_without_slabs(body, before, ALL_STAY)) == [0, NO_PART, 1, 2]
    assert origins(bones_without_slabs(body, before, ALL_STAY, SlabsSettings(length=9.0))) == [0, NO_PART, 2]


def test_a_tree_without_hidden_bones_keeps_its_slabs() -> None:
    body = chain((0.0, 0.3), swings(24, 3, seed=3), along=60)
    before = cut_by_height(body, (0.0, 0.3))
    assert bones_without_slabs(in_takes(body), before, ALL_STAY) is before


def test_a_single_take_keeps_its_slabs() -> None:
    assert origins(bones_without_slabs(surface(soft_neck()), cut_amiss(), ALL_STAY)) == [0, NO_PART, 1, 2]
