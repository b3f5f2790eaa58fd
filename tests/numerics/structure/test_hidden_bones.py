"""A bone that no vertex follows alone is found between its neighbours, and none where one joint does."""

from typing import Any

import numpy as np
import pytest
from articulated import Known, chain, moved, neck, neck_ends, swings

from kinetree.tasks.numerics.structure.blended_bone import MovingSkin
from kinetree.tasks.numerics.structure.hidden_bones import (
    Border,
    HiddenBone,
    HiddenBonesSettings,
    hidden_bone,
    is_bone,
)


def proposed(body: Known, takes: list[slice] | None = None) -> HiddenBone | None:
    found = neck_ends(body)
    scale = float(np.ptp(body.V[:, 2])) / 10.0
    skin = MovingSkin(body.V, body.x, body.area, found.W, found.R, found.t)
    return hidden_bone(skin, Border(1, 0, found.rest[1], scale, float(found.drift[1])), takes=takes)


@pytest.mark.parametrize(("half", "blend"), [(0.6, 2.4), (0.9, 2.4), (1.2, 2.0)])
def test_joints_and_motion_of_a_bone_that_moves_no_vertex_alone(half: float, blend: float) -> None:
    body = neck(half, blend)
    bone = proposed(body)
    assert bone is not None
    np.testing.assert_allclose(bone.joint, body.joints[1:], atol=0.03)
    turn = np.einsum("txy,txz->tyz", bone.R, body.R[:, 1])
    assert np.degrees(np.arccos(np.clip((np.trace(turn, axis1=1, axis2=2) - 1) / 2, -1, 1))).max() < 1.0
    assert bone.degrees.min() > 40.0
    assert (np.abs(body.V[bone.skin, 2]) < half + blend / 2).all()


def test_skin_that_blends_two_parts_about_one_joint_hides_no_bone() -> None:
    body = neck(0.9, 2.4)
    W = np.stack([body.W[:, 0] + body.W[:, 1] / 2, body.W[:, 2] + body.W[:, 1] / 2], axis=1)
    assert proposed(moved(body.V, body.F, W, body.joints[[0, 2]] * [1, 1, 0], np.array([-1, 0]), one_still(2))) is None


def test_two_parts_that_slide_against_each_other_have_no_bone_between_them() -> None:
    body = chain((0.0,), one_still(2), blend=2.4, along=60)
    t = body.t.copy()
    t[:, 1] += np.random.default_rng(0).normal(0.0, 0.03, t[:, 1].shape)
    x = np.einsum("vp,tpvx->tvx", body.W, np.einsum("tpxy,vy->tpvx", body.R, body.V) + t[:, :, None])
    slid = body._replace(x=x, t=t)
    assert neck_ends(slid).drift[1] > 0.003 * np.sqrt(body.area.sum())
    assert proposed(slid) is None


def test_a_ring_of_flesh_that_turns_half_way_about_the_same_joint_is_no_bone() -> None:
    body, half = neck(0.9, 2.4), one_still(3, 15.0)
    half[:, 2] = half[:, 1]
    assert proposed(moved(body.V, body.F, body.W, body.joints * [[1], [0], [0]], body.parents, half)) is None


def one_still(parts: int, degrees: float = 30.0) -> np.ndarray:
    turn = swings(24, parts, degrees, seed=3)
    turn[:, 0] = np.eye(3)
    return turn


def test_a_bone_grows_with_the_body() -> None:
    body = neck()
    one, two = proposed(body), proposed(body._replace(V=7 * body.V, x=7 * body.x, t=7 * body.t))
    assert one is not None
    assert two is not None
    np.testing.assert_allclose(two.joint, 7 * one.joint, atol=0.05)
    assert two.area == pytest.approx(49 * one.area, rel=0.02)


@pytest.mark.parametrize(
    ("change", "unasked"),
    [
        ({"area": 0.01}, {}),
        ({"degrees": np.array([5.0, 40.0])}, {}),
        ({"drift": np.array([0.0, 0.06])}, {}),
        ({"widest_drift": np.array([0.0, 0.2])}, {}),
        ({"widest_drift": np.array([0.0, 1.5])}, {"more_drift": 99.0}),
        ({"joint": np.array([[0, 0, 0], [0, 0, 0.5]])}, {}),
    ],
    ids=["area", "degrees", "steady", "more_drift", "ratio", "apart"],
)
def test_every_sign_of_a_bone_is_asked_for(change: dict[str, Any], unasked: dict[str, float]) -> None:
    body = neck()
    bone = proposed(body)
    between, size = Border(1, 0, np.zeros(3), 1.0, 0.05), float(np.sqrt(body.area.sum()))
    asked = HiddenBonesSettings(**unasked)
    assert bone is not None
    assert is_bone(bone, between, size, asked)
    assert not is_bone(bone._replace(**change), between, size, asked)


def test_a_bone_that_turns_against_a_side_in_one_take_alone_turns() -> None:
    body = neck()
    still = 30 * len(body.x)
    long = body._replace(
        x=np.concatenate([body.x, np.repeat(body.x[:1], still, 0)]),
        R=np.concatenate([body.R, np.repeat(body.R[:1], still, 0)]),
        t=np.concatenate([body.t, np.repeat(body.t[:1], still, 0)]),
    )
    takes = [slice(0, len(body.x)), slice(len(body.x), len(long.x))]
    alone, together, parted = proposed(body), proposed(long), proposed(long, takes)
    assert alone is not None
    assert parted is not None
    assert parted.degrees.min() == pytest.approx(alone.degrees.min(), abs=2.0)
    assert together is None or together.degrees.min() < parted.degrees.min() - 5.0


def test_a_joint_that_does_not_drift_needs_no_second() -> None:
    body = neck()
    bone = proposed(body)
    size = float(np.sqrt(body.area.sum()))
    assert bone is not None
    bone = bone._replace(widest_drift=np.full(2, 1e-4 * size))
    for drift, needed in ((0.002, True), (0.001, True), (0.00015, False)):
        between = Border(1, 0, np.zeros(3), 1.0, drift * size)
        assert is_bone(bone, between, size, HiddenBonesSettings()) is needed


def test_where_the_one_joint_drifts_little_for_its_width_two_may_not_drift_more() -> None:
    body = neck()
    bone = proposed(body)
    size = float(np.sqrt(body.area.sum()))
    assert bone is not None
    bone, asked = bone._replace(widest_drift=np.full(2, 0.003 * size)), HiddenBonesSettings(apart=0.0)
    for radius, is_one in ((0.02 * size, True), (0.1 * size, False)):
        assert is_bone(bone, Border(1, 0, np.zeros(3), radius, 0.002 * size), size, asked) is is_one
    assert is_bone(bone, Border(1, 0, np.zeros(3), 0.1 * size, 0.0035 * size), size, asked)
