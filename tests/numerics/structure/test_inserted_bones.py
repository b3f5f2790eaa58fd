"""Hidden bones become parts of the tree."""

import numpy as np
from articulated import Known, and_at_rest, chain, neck, neck_ends, swings
from shipped import TREE
from whole_tree import whole_tree

from kinetree.tasks.numerics.structure.hidden_bones import HiddenBonesSettings
from kinetree.tasks.numerics.structure.inserted_bones import inserted_bones
from kinetree.tasks.numerics.structure.kinematic_tree import Derivation, KinematicTree
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.pruning import NO_PART
from kinetree.tasks.numerics.structure.tree_joints import Cut, TreeJoints


def with_bones(body: Known) -> tuple[TreeJoints, TreeJoints]:
    found = neck_ends(body)
    return found, inserted_bones(MovingSurface(body.V, body.F, body.x, body.area), found, 0.002)


def in_pose(body: Known, frame: int) -> Cut:
    """The first and the last part, cut in the pose of a frame."""
    ends = [0, body.R.shape[1] - 1]
    R = body.R[:, ends] @ body.R[frame, ends].transpose(0, 2, 1)
    t = body.t[:, ends] - np.einsum("tpxy,py->tpx", R, body.t[frame, ends])
    return Cut(body.x[frame], (body.V[:, 2] > 0.0).astype(np.int64), R, t, body.residual[:, ends])


def whole(
    body: Known, hidden_bones: bool = True, confidence: np.ndarray | None = None, further: tuple[Cut, ...] = ()
) -> tuple[KinematicTree, Derivation]:
    ends = [0, body.R.shape[1] - 1]
    label, tips = (body.V[:, 2] > 0.0).astype(np.int64), np.array([body.V[:, 2].argmin(), body.V[:, 2].argmax()])
    cut = Cut(body.V, label, body.R[:, ends], body.t[:, ends], body.residual[:, ends])
    surface = MovingSurface(body.V, body.F, body.x, body.area)
    return whole_tree(surface, cut, tips, confidence, settings=TREE._replace(hidden_bones=hidden_bones), further=further)


def test_the_bone_stands_between_its_two_parts() -> None:
    before, after = with_bones(neck())
    tree = after.left.part_tree.tree
    assert tree.parents.tolist() == [-1, 0, 1]
    assert tree.order.tolist() == [int(before.left.part_tree.tree.order[0]), 2, int(before.left.part_tree.tree.order[1])]
    assert after.left.origin.tolist() == [*before.left.origin.tolist(), NO_PART]
    assert after.left.part_tree.borders.pair[tree.border[1:]].tolist() == [[tree.order[0], 2], [tree.order[2], 2]]
    np.testing.assert_allclose(after.rest[1:], neck().joints[1:], atol=0.03)


def test_parts_are_the_same_by_number_and_by_place() -> None:
    _, after = with_bones(neck())
    order = after.left.part_tree.tree.order
    np.testing.assert_array_equal(after.left.parts.R[:, order], after.R)
    np.testing.assert_array_equal(after.left.parts.t[:, order], after.t)
    np.testing.assert_array_equal(order[after.label], after.left.parts.label)
    assert set(after.label) == {0, 1, 2}


def test_weights_of_the_skin_are_shared_with_the_bone() -> None:
    body = neck()
    _, after = with_bones(body)
    np.testing.assert_allclose(after.W.sum(axis=1), 1.0)
    assert np.abs(after.W - body.W).mean() < 0.02


def test_a_neck_of_two_bones_has_three_joints() -> None:
    body = chain((-1.5, 0.0, 1.5), swings(24, 4, 20.0, seed=1), blend=2.0, along=60)
    surface, found = MovingSurface(body.V, body.F, body.x, body.area), neck_ends(body)
    asked = HiddenBonesSettings(steady=0.1)
    one, two = (inserted_bones(surface, found, 0.002, asked._replace(generations=g)) for g in (1, 2))
    assert [len(tree.rest) - 1 for tree in (one, two)] == [2, 3]
    assert abs(one.rest[1:, 2] + 1.5).min() > 0.2
    assert abs(two.rest[1:, 2] + 1.5).min() < 0.05


def test_a_tree_without_hidden_bones_is_given_back() -> None:
    body = chain((0.0,), swings(24, 2, seed=3), blend=1.0)
    before, after = with_bones(body)
    assert after is before


def test_takes_in_which_the_body_rests_do_not_hide_a_bone() -> None:
    body, takes = and_at_rest(chain((-0.9, 0.9), swings(24, 3, 12.0, seed=3), blend=2.4, along=60), 24)
    surface, joints = MovingSurface(body.V, body.F, body.x, body.area), neck_ends(body)
    asked = HiddenBonesSettings(drift=0.03, less_drift=0.0)
    assert inserted_bones(surface, joints, 0.002, asked) is joints, "over all frames its joint drifts little"
    after = inserted_bones(surface._replace(takes=takes), joints, 0.002, asked)
    np.testing.assert_allclose(after.rest[1:], body.joints[1:], atol=0.01)


def test_the_finished_body_has_both_joints_where_they_are_in_every_frame() -> None:
    body = neck()
    found, derived = whole(body)
    assert found.kinds.count("joint") == 2
    turning = [j for j, kind in enumerate(found.kinds) if kind == "joint"]
    true = np.einsum("tpxy,py->tpx", body.R[:, [0, 1]], body.joints[1:]) + body.t[:, [0, 1]]
    apart = np.linalg.norm(found.positions[:, turning][:, :, None] - true[:, None], axis=3).mean(axis=0).min(axis=1)
    assert apart.max() < 0.05
    assert sorted(derived.joint_of_part.tolist()) == [0, 2]


def test_no_bone_is_looked_for_where_not_every_vertex_was_followed_or_none_is_wanted() -> None:
    body = neck()
    for found, _ in (whole(body, False), whole(body, confidence=np.full(body.x.shape[:2], 0.99))):
        assert found.kinds.count("joint") == 1


def test_further_cuts_look_for_the_bone_too_so_that_both_joints_have_a_spread() -> None:
    body = neck()
    found, derived = whole(body, further=(in_pose(body, 5),))
    turning = np.array([kind == "joint" for kind in found.kinds])
    assert derived.agreeing[turning].tolist() == [2, 2]
    assert (derived.spread[turning] < 0.2).all()
