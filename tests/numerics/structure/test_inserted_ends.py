"""Joints that the frames show within the last parts of limbs become parts of the tree."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from shipped import TREE
from smeared import END, Frames, aligned, found_in, moving, turning
from whole_tree import whole_tree

from kinetree.tasks.numerics.structure.inserted_bones import NO_PART
from kinetree.tasks.numerics.structure.inserted_ends import inserted_ends
from kinetree.tasks.numerics.structure.kinematic_tree import Derivation, KinematicTree
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.tree_joints import Cut, TreeJoints


def with_ends(degrees: float = 25.0) -> tuple[MovingSurface, TreeJoints, MovingSurface, TreeJoints]:
    before, found = found_in(aligned(turning(degrees)))
    ones = np.ones(before.x.shape[:2])
    return before, found, *inserted_ends(before, found, ones, Frames(turning(degrees)).prepared(before.size), 0.002)


def whole(end_joints: bool, degrees: float = 25.0) -> tuple[KinematicTree, Derivation]:
    body, ones = aligned(turning(degrees)), np.ones((24, len(aligned(turning(degrees)).V)))
    label, tips = (body.V[:, 2] > 0.0).astype(np.int64), np.array([body.V[:, 2].argmin(), body.V[:, 2].argmax()])
    cut, evidence = Cut(body.V, label, body.R[:, :2], body.t[:, :2], body.residual[:, :2]), Frames(turning(degrees)).evidence()
    return whole_tree(moving(body), cut, tips, ones, evidence, settings=TREE._replace(end_joints=end_joints))


def test_the_new_part_hangs_on_the_one_that_it_was_cut_from() -> None:
    _, before, _, after = with_ends()
    tree = after.left.part_tree.tree
    assert tree.parents.tolist() == [*before.left.part_tree.tree.parents.tolist(), 1]
    assert after.left.origin.tolist() == [*before.left.origin.tolist(), NO_PART]
    pair = after.left.part_tree.borders.pair[tree.border[2]]
    assert sorted(pair.tolist()) == sorted([int(tree.order[1]), 2])
    np.testing.assert_allclose(after.rest[2], [0.0, 0.0, END], atol=0.4)
    assert after.left.part_tree.degrees[2] == pytest.approx(50.0, abs=12.0)
    assert after.drift[2] < 0.01 * np.sqrt(aligned(turning()).area.sum())


def test_parts_are_the_same_by_number_and_by_place() -> None:
    *_, after = with_ends()
    order = after.left.part_tree.tree.order
    np.testing.assert_array_equal(after.left.parts.R[:, order], after.R)
    np.testing.assert_array_equal(after.left.parts.t[:, order], after.t)
    np.testing.assert_array_equal(order[after.label], after.left.parts.label)
    assert set(after.label) == {0, 1, 2}
    np.testing.assert_allclose(after.W.sum(axis=1), 1.0)


def test_the_surface_beyond_the_joint_lies_on_the_frames() -> None:
    before, _, after, _ = with_ends()
    z, true = before.V[:, 2], Frames(turning()).true
    want = np.einsum("txy,vy->tvx", true.R[:, 2], before.V) + true.t[:, None, 2]
    tip = z > END + 0.5
    # about its own axis a round tube is free: its middle line tells
    middle = [x[:, tip].mean(axis=1) for x in (before.x, after.x, want)]
    assert np.linalg.norm(middle[1] - middle[2], axis=1).max() < 0.2
    assert np.linalg.norm(middle[0] - middle[2], axis=1).max() > 0.5
    np.testing.assert_array_equal(after.x[:, z < 0.0], before.x[:, z < 0.0])


def test_the_surface_is_not_torn_at_the_joint() -> None:
    before, _, after, tree = with_ends()
    edge = np.unique(np.sort(before.F[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)
    near = np.abs(before.V[edge, 2] - END).max(axis=1) < 1.5
    rest = np.linalg.norm(before.V[edge[near, 0]] - before.V[edge[near, 1]], axis=1)
    skin = np.einsum("vp,tpvx->tvx", tree.W, np.einsum("tpxy,vy->tpvx", tree.R, before.V) + tree.t[:, :, None])
    for x in (after.x, skin):
        length = np.linalg.norm(x[:, edge[near, 0]] - x[:, edge[near, 1]], axis=2)
        # bent by 25° over one radius, the outer side is longer by 0.44; as a step it is so on one edge of 0.17
        assert (length - rest).max() < 0.2


def test_the_piece_before_the_joint_moves_as_in_the_frames_too() -> None:
    # the alignment smears: the whole part goes half of the way with its end
    body, true = aligned(turning()), Frames(turning()).true
    half = np.stack([turn_by_half(Q) for Q in turning()[:, 2]])
    smeared = body.x.copy()
    part = body.V[:, 2] > 0.0
    R = body.R[:, 1] @ half
    smeared[:, part] = np.einsum("txy,vy->tvx", R, body.V[part]) + body.t[:, 1, None]
    body = body._replace(x=smeared, R=np.stack([body.R[:, 0], R, R], axis=1))
    surface, found = found_in(body)
    shown = Frames(turning()).prepared(surface.size)
    moved, after = inserted_ends(surface, found, np.ones(smeared.shape[:2]), shown, 0.002)
    axis = [off(tree.R[:, 1], true.R[:, 1]) for tree in (found, after)]
    assert axis[0].max() > 10.0
    assert axis[1].max() < 5.0
    near = (surface.V[:, 2] > 0.5) & (surface.V[:, 2] < END - 0.7)
    want = np.einsum("txy,vy->tvx", true.R[:, 1], surface.V[near]) + true.t[:, 1, None]
    middle = [np.linalg.norm((x[:, near] - want).mean(axis=1), axis=1).max() for x in (surface.x, moved.x)]
    assert middle[1] < 0.4 * middle[0]


def turn_by_half(Q: np.ndarray) -> np.ndarray:
    return np.asarray(Rotation.from_rotvec(Rotation.from_matrix(Q).as_rotvec() / 2).as_matrix())


def off(R: np.ndarray, true: np.ndarray) -> np.ndarray:
    """(frame,) degrees between the tube's axis as two rotations turn it: it is free about itself."""
    return np.degrees(np.arccos(np.clip(np.einsum("tx,tx->t", R[:, :, 2], true[:, :, 2]), -1.0, 1.0)))


def test_a_tree_whose_ends_do_not_turn_is_given_back() -> None:
    surface, before, same, after = with_ends(0.0)
    assert after is before
    assert same is surface


def test_the_finished_body_has_the_joint_in_every_frame() -> None:
    tree, derivation = whole(True)
    assert sum(kind == "joint" for kind in tree.kinds) == 2
    new = int(np.argmax(tree.rest[:, 2] * [kind == "joint" for kind in tree.kinds]))
    true = Frames(turning()).true
    where = np.einsum("txy,y->tx", true.R[:, 1], true.joints[2]) + true.t[:, 1]
    assert np.linalg.norm(tree.positions[:, new] - where, axis=1).max() < 0.5
    assert tree.degrees[new] > 30.0
    assert new not in derivation.joint_of_part
    assert derivation.agreeing[new] == 1
    assert derivation.end_joints == (new,)


def test_without_the_setting_the_body_stays_as_aligned() -> None:
    tree, derivation = whole(False)
    assert sum(kind == "joint" for kind in tree.kinds) == 1
    assert derivation.end_joints == ()
    assert sum(kind == "joint" for kind in whole(True, 0.0)[0].kinds) == 1
