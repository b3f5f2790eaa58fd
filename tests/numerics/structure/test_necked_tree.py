"""A neck becomes a bone between its part and the part above."""

from functools import cache

import numpy as np
import pytest
from bottles import BOTTOM, TOP, bottle
from scipy.spatial.transform import Rotation
from shipped import TREE
from whole_tree import whole_tree

from kinetree.tasks.numerics.geometry.surface import Surface
from kinetree.tasks.numerics.structure.first_tree import first_tree
from kinetree.tasks.numerics.structure.kinematic_tree import Derivation, KinematicTree
from kinetree.tasks.numerics.structure.necked_tree import PlacedJoints, necked_tree
from kinetree.tasks.numerics.structure.necks import necks
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.tree_joints import Cut


def nodding_cut(joint: float) -> tuple[MovingSurface, Cut, np.ndarray]:
    """A bottle of two rigid parts that turn by 40° about a point of its neck, in twelve frames; its cut and its tips."""
    V, F = bottle(3.0, 1.8)
    turn = Rotation.from_rotvec(np.radians(20.0) * np.stack([np.sin(np.arange(12.0)), *np.zeros((2, 12))], axis=1)).as_matrix()
    R = np.stack([np.tile(np.eye(3), (12, 1, 1)), turn], axis=1)
    c = np.array([0.0, 0.0, joint])
    t = np.stack([np.zeros((12, 3)), c - turn @ c], axis=1)
    label = (V[:, 2] > joint).astype(np.int64)
    x = np.einsum("tvxy,vy->tvx", R[:, label], V) + t[:, label]
    surface = MovingSurface(V, F, x, Surface.of(V, F).area)
    tips = np.array([V[:, 2].argmin(), V[:, 2].argmax()])
    return surface, Cut(V, label, R, t, np.zeros((12, 2))), tips


@cache
def nodding(joint: float, has_necks: bool) -> tuple[KinematicTree, Derivation]:
    surface, cut, tips = nodding_cut(joint)
    return whole_tree(surface, cut, tips, settings=TREE._replace(hidden_bones=False), has_necks=has_necks)


def test_the_neck_stands_between_its_part_and_the_part_above() -> None:
    body, cut, tips = nodding_cut(TOP)
    before = first_tree(body, cut, tips, settings=TREE._replace(hidden_bones=False))
    hanging = list(necks(body.V, body.F, before.label, before.parents, before.rest, before.radius))
    known = PlacedJoints(before.rest, np.array([np.nan, 0.1]), np.array([np.nan, 0.2]), np.array([0, 4]))
    after, joints, is_new = necked_tree(body, before, known, hanging)
    assert (after.parents.tolist(), is_new.tolist()) == ([-1, 0, 1], [False, True, False])
    np.testing.assert_allclose(joints.rest[2], before.rest[1])
    np.testing.assert_array_equal(joints.offset, [np.nan, np.nan, 0.1])
    np.testing.assert_array_equal(joints.agreeing, [0, 1, 4])
    np.testing.assert_allclose(after.W.sum(axis=1), 1.0)
    z = body.V[:, 2]
    assert set(after.label[(z > BOTTOM + 0.4) & (z < TOP - 0.4)]) == {1}
    half = np.degrees(Rotation.from_matrix(after.R[:, 1].transpose(0, 2, 1) @ after.R[:, 2]).magnitude())
    whole = np.degrees(Rotation.from_matrix(after.R[:, 0].transpose(0, 2, 1) @ after.R[:, 2]).magnitude())
    np.testing.assert_allclose(2.0 * half, whole, atol=1e-6)


def joint_heights(tree: KinematicTree) -> list[float]:
    return sorted(float(p[2]) for p, kind in zip(tree.rest, tree.kinds, strict=True) if kind == "joint")


@pytest.mark.parametrize("joint", [BOTTOM, TOP])
def test_the_finished_body_has_a_joint_at_both_ends(joint: float) -> None:
    tree, derivation = nodding(joint, True)
    assert joint_heights(tree) == pytest.approx([BOTTOM, TOP], abs=0.5)
    (new,) = derivation.neck_joints
    assert tree.rest[new, 2] == pytest.approx(BOTTOM + TOP - joint, abs=0.5)
    assert (derivation.agreeing[new], np.isnan(derivation.spread[new])) == (1, True)


@pytest.mark.parametrize("joint", [BOTTOM, TOP])
def test_the_joint_that_turns_stays(joint: float) -> None:
    (one, _), (two, derivation) = nodding(joint, False), nodding(joint, True)
    turning = next(k for k, kind in enumerate(two.kinds) if kind == "joint" and k not in derivation.neck_joints)
    (before,) = (p for p, kind in zip(one.rest, one.kinds, strict=True) if kind == "joint")
    np.testing.assert_allclose(two.rest[turning], before)


def test_lengths_are_held_and_weights_sum_to_one() -> None:
    tree, derivation = nodding(BOTTOM, True)
    (new,) = derivation.neck_joints
    length = np.linalg.norm(tree.positions[:, new] - tree.positions[:, tree.parents[new]], axis=1)
    np.testing.assert_allclose(length, length[0], rtol=1e-6)
    np.testing.assert_allclose(tree.weight.sum(axis=1), 1.0, rtol=1e-5)


def test_not_asked_for_there_is_none() -> None:
    tree, derivation = nodding(BOTTOM, False)
    assert (len(joint_heights(tree)), derivation.neck_joints) == (1, ())
