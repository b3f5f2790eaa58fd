"""A part whose vertices follow its neighbours nearly as much is moved as it turns, and others are left alone."""

import numpy as np
import pytest
from articulated import Known, and_at_rest, chain, cut_by_height, surface, swings

from kinetree.tasks.numerics.structure.loose_parts import LoosePartsSettings, tightened
from kinetree.tasks.numerics.structure.pruning import NO_PART
from kinetree.tasks.numerics.structure.tree_joints import TreeJoints


def error_of_turning(joints: TreeJoints, body: Known, place: int, part: int) -> float:
    """Largest angle between a part's rotation and the true one, degrees."""
    apart = np.einsum("txy,txz->tyz", joints.R[:, place], body.R[:, part])
    return float(np.degrees(np.arccos(np.clip((np.trace(apart, axis1=1, axis2=2) - 1) / 2, -1, 1))).max())


def soft_chain() -> tuple[Known, TreeJoints, int, int]:
    """A tube of four parts, the third short and soft, cut amiss there · the places of the third and the last."""
    body = chain((-2.5, 1.0, 2.2), swings(24, 4, 40.0, seed=0), blend=2.0, along=60)
    joints = cut_by_height(body, (-2.5, 0.4, 2.2))
    own, last = (int(np.flatnonzero(joints.left.part_tree.tree.order == p)[0]) for p in (2, 3))
    assert joints.left.part_tree.tree.parents[last] == own
    return body, joints, own, last


def test_a_mixture_of_its_neighbours_becomes_the_part_that_turns_about_both_joints() -> None:
    body, before, own, last = soft_chain()
    after = tightened(surface(body), before, 0.002)
    assert error_of_turning(before, body, own, 2) > 10.0
    assert error_of_turning(after, body, own, 2) < 2.0
    np.testing.assert_allclose(after.rest[[own, last], 2], [1.0, 2.2], atol=0.05)
    assert after.drift[[own, last]].max() < 0.2 * before.drift[[own, last]].max()
    assert np.abs(after.W[:, own] - body.W[:, 2]).mean() < 0.5 * np.abs(before.W[:, own] - body.W[:, 2]).mean()


def test_parts_are_the_same_by_number_and_by_place_and_the_others_move_as_before() -> None:
    body, before, own, last = soft_chain()
    after = tightened(surface(body), before, 0.002)
    order, others = after.left.part_tree.tree.order, np.arange(4) != own
    np.testing.assert_array_equal(after.left.parts.R[:, order], after.R)
    np.testing.assert_array_equal(after.left.parts.t[:, order], after.t)
    np.testing.assert_array_equal(after.R[:, others], before.R[:, others])
    assert after.residual[last] != before.residual[last]


def test_a_body_and_its_enlargement_have_the_same_joints() -> None:
    body, before, own, last = soft_chain()
    large = body._replace(V=7 * body.V, x=7 * body.x, t=7 * body.t)
    one = tightened(surface(body), before, 0.002)
    seven = tightened(surface(large), cut_by_height(large, (-17.5, 2.8, 15.4)), 0.014)
    np.testing.assert_allclose(seven.rest[[own, last]], 7 * one.rest[[own, last]], atol=0.02)


@pytest.mark.parametrize("change", [{"drift": 0.3}, {"longest": 0.5}, {"shortest": 3.0}, {"less_drift": 0.01}])
def test_every_sign_of_a_loose_part_is_asked_for(change: dict[str, float]) -> None:
    body, before, _, _ = soft_chain()
    assert tightened(surface(body), before, 0.002, LoosePartsSettings(**change)) is before


def test_a_hidden_bone_which_was_blended_already_is_left_alone() -> None:
    body, before, own, _ = soft_chain()
    origin = before.left.origin.copy()
    origin[before.left.part_tree.tree.order[own]] = NO_PART
    hidden = before._replace(left=before.left._replace(origin=origin))
    assert tightened(surface(body), hidden, 0.002) is hidden


def test_takes_in_which_the_body_rests_do_not_hide_a_loose_part() -> None:
    body, _, own, last = soft_chain()
    long, takes = and_at_rest(body, 24)
    before = cut_by_height(long, (-2.5, 0.4, 2.2))
    assert tightened(surface(long), before, 0.002) is before, "over all frames its joints drift little"
    after = tightened(surface(long)._replace(takes=takes), before, 0.002)
    assert error_of_turning(after, long, own, 2) < 2.0
    np.testing.assert_allclose(after.rest[[own, last], 2], [1.0, 2.2], atol=0.05)
