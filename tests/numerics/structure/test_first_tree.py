"""The tree of the first cut, as other steps read it."""

from typing import Any

import numpy as np
import pytest
from articulated import ALL_STAY, chain, neck, swings
from shipped import TREE
from smeared import moving

from kinetree.tasks.numerics.structure import tree_joints as structure_tree_joints
from kinetree.tasks.numerics.structure.centre_lines import ExpectedJoints
from kinetree.tasks.numerics.structure.first_tree import FirstTree, first_tree, in_reference, in_tree_order
from kinetree.tasks.numerics.structure.rotation_centres import Joints, rotation_centres
from kinetree.tasks.numerics.structure.tree_joints import Cut, tree_joints

NO_LEAVES = np.zeros(0, int)


def test_a_part_knows_its_place_and_one_that_was_dropped_has_none() -> None:
    turn = swings(24, 3)
    turn[:, 2] = np.eye(3)
    body = chain((-1.0, 2.0), turn)
    tree = first_tree(moving(body), Cut(body.V, body.label, body.R, body.t, body.residual), NO_LEAVES, settings=TREE)
    (dropped,) = tree.graph.dropped
    assert tree.place[dropped.part] == -1
    for part in {0, 1, 2} - {dropped.part}:
        np.testing.assert_array_equal(tree.R[:, tree.place[part]], body.R[:, part])


def test_bones_that_no_cut_finds_are_recognised() -> None:
    body = neck()
    ends = [0, body.R.shape[1] - 1]
    cut = Cut(body.V, (body.V[:, 2] > 0.0).astype(np.int64), body.R[:, ends], body.t[:, ends], body.residual[:, ends])
    tips = np.array([body.V[:, 2].argmin(), body.V[:, 2].argmax()])
    trees = [first_tree(moving(body), cut, tips, settings=TREE._replace(hidden_bones=h)) for h in (True, False)]
    assert [tree.has_bones for tree in trees] == [True, False]


def test_joints_drift_as_much_as_where_they_were_found() -> None:
    body = chain((0.0,), swings(16, 2))
    cut = Cut(body.V, body.label, body.R, body.t, body.residual)
    found = tree_joints(moving(body), cut, NO_LEAVES, settings=TREE)
    tree = in_tree_order(found, 2)
    np.testing.assert_allclose(tree.drift_at(tree.rest), found.drift, atol=1e-12)
    assert tree.drift_at(tree.rest + 1.0)[1] > tree.drift[1]
    np.testing.assert_array_equal(tree.motion.R, found.motion.R)


def test_a_joint_of_a_long_part_is_held_on_its_line_unless_every_vertex_was_followed(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Any] = []

    def remember(*args: Any) -> Joints:
        asked.append(args)
        return rotation_centres(*args)

    monkeypatch.setattr(structure_tree_joints, "rotation_centres", remember)
    body = chain((-1.0, 2.0), swings(16, 3))
    cut = Cut(body.V, body.label, body.R, body.t, body.residual)
    a = np.array([0.0, 0.0, 1.0])
    line = ExpectedJoints(np.zeros((2, 3)), np.stack([np.outer(a, a), 0.0 * np.eye(3)]))
    monkeypatch.setattr(structure_tree_joints, "towards_centre_lines", lambda *_: line)
    confidence = np.ones(body.x.shape[:2])
    tree_joints(moving(body), cut, NO_LEAVES, settings=TREE)
    tree_joints(moving(body), cut, NO_LEAVES, confidence, settings=TREE)
    given, followed = asked
    assert given[8] is None
    np.testing.assert_array_equal(followed[8], line.lines)
    np.testing.assert_array_equal(followed[3], line.place)
    assert (followed[7].across, followed[7].along, followed[7].spread) == (TREE.across, TREE.along, TREE.spread)
    assert TREE.across < TREE.spread <= TREE.along


def test_the_tree_of_a_cut_in_another_pose_is_the_same_tree_in_the_reference() -> None:
    """The reference is the second frame, the pose the sixth."""
    body, frame, pose = chain((-1.0, 2.0), swings(16, 3)), 1, 5

    def tree_in(k: int) -> tuple[FirstTree, Cut]:
        R = np.einsum("tpxy,pzy->tpxz", body.R, body.R[k])
        cut = Cut(body.x[k], body.label, R, body.t - np.einsum("tpxy,py->tpx", R, body.t[k]), body.residual)
        return in_tree_order(tree_joints(moving(body)._replace(V=body.x[k]), cut, NO_LEAVES, settings=TREE), 3), cut

    (own, _), (other, cut) = tree_in(frame), tree_in(pose)
    found = in_reference(other, cut, frame)
    np.testing.assert_allclose(found.R[frame], np.tile(np.eye(3), (3, 1, 1)), atol=1e-9)
    np.testing.assert_allclose(found.t[frame], 0.0, atol=1e-9)
    for name in ("R", "t"):
        np.testing.assert_allclose(getattr(found, name), getattr(own, name), atol=1e-6)
    np.testing.assert_allclose(found.rest, own.rest, atol=0.05)
    np.testing.assert_allclose(found.graph.centre, own.graph.centre, atol=0.05)
    np.testing.assert_allclose(found.motion.carried(found.rest[1:]), other.motion.carried(other.rest[1:]), atol=0.05)
    np.testing.assert_array_equal(found.graph.part, body.label)
    np.testing.assert_allclose(found.drift, found.drift_at(found.rest), atol=1e-12)
    np.testing.assert_allclose(found.graph.border_drift, own.graph.border_drift, atol=0.05)


def test_its_borders_lie_midway_between_where_both_parts_carry_them() -> None:
    body, frame, pose = chain((-1.0, 2.0), swings(16, 3)), 1, 5
    R = np.einsum("tpxy,pzy->tpxz", body.R, body.R[pose])
    t = body.t - np.einsum("tpxy,py->tpx", R, body.t[pose]) + 0.3 * np.random.default_rng(0).normal(size=body.t.shape)
    cut = Cut(body.x[pose], body.label, R, t, body.residual)
    tree = in_tree_order(tree_joints(moving(body)._replace(V=body.x[pose]), cut, NO_LEAVES, settings=ALL_STAY), 3)
    found = in_reference(tree, cut, frame)
    for (a, b), before, after, off in zip(
        tree.graph.pair, tree.graph.centre, found.graph.centre, found.graph.border_drift, strict=True
    ):
        sides = [R[frame, part] @ before + t[frame, part] for part in (a, b)]
        np.testing.assert_allclose(after, np.mean(sides, axis=0), atol=1e-9)
        back = [np.linalg.inv(R[frame, part]) @ (after - t[frame, part]) for part in (a, b)]
        apart = [R[f, a] @ back[0] + t[f, a] - R[f, b] @ back[1] - t[f, b] for f in range(len(R))]
        assert off == pytest.approx(np.sqrt((np.array(apart) ** 2).sum(axis=1).mean()))


def test_every_vertex_keeps_the_number_of_its_part_though_another_part_has_no_vertices() -> None:
    body = chain((0.0,), swings(16, 2))
    R, t = (np.insert(a, 1, a[:, 0], axis=1) for a in (body.R, body.t))
    cut = Cut(body.V, np.where(body.label == 1, 2, 0), R, t, np.zeros(R.shape[:2]))
    tree = first_tree(moving(body), cut, NO_LEAVES, settings=TREE)
    np.testing.assert_array_equal(tree.graph.part, cut.label)
    assert tree.graph.pair.tolist() == [[0, 2]]
