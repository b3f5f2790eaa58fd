"""Joints that the frames show within the last parts of limbs become parts of the tree."""

import numpy as np
import pytest
from articulated import Known
from scipy.spatial.transform import Rotation
from shipped import TREE
from smeared import END, Frames, aligned, found_in, moving, turning
from trunk import LIMBS, MIRRORED, trunk
from whole_tree import joints_at_ends, whole_tree

from kinetree.tasks.numerics.structure.end_joints import EndJointsSettings
from kinetree.tasks.numerics.structure.evident_rings import EvidentRingsSettings
from kinetree.tasks.numerics.structure.extended_tree import extended_tree, moved_ends
from kinetree.tasks.numerics.structure.first_tree import FirstTree, in_tree_order
from kinetree.tasks.numerics.structure.kinematic_tree import Derivation, KinematicTree
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.tree_joints import Cut


def with_ends(degrees: float = 25.0) -> tuple[MovingSurface, FirstTree, np.ndarray, FirstTree]:
    """The surface and its tree before, its vertices and the tree after."""
    return extended(aligned(turning(degrees)), degrees)


def extended(known: Known, degrees: float = 25.0) -> tuple[MovingSurface, FirstTree, np.ndarray, FirstTree]:
    body, found = found_in(known)
    tree, ones = in_tree_order(found, 2), np.ones(body.x.shape[:2])
    ends = joints_at_ends(body, tree, ones, Frames(turning(degrees)).prepared(body.size))
    return body, tree, moved_ends(body, tree, ends), extended_tree(body, tree, ends, ones, 0.002)


def whole(is_asked: bool, degrees: float = 25.0) -> tuple[KinematicTree, Derivation]:
    body, ones = aligned(turning(degrees)), np.ones((24, len(aligned(turning(degrees)).V)))
    label, tips = (body.V[:, 2] > 0.0).astype(np.int64), np.array([body.V[:, 2].argmin(), body.V[:, 2].argmax()])
    cut, frames = Cut(body.V, label, body.R[:, :2], body.t[:, :2], body.residual[:, :2]), Frames(turning(degrees))
    surface = frames.prepared(moving(body).size) if is_asked else None
    return whole_tree(moving(body), cut, tips, ones, frames.evidence(), settings=TREE, surface=surface)


def test_the_new_part_hangs_on_the_one_that_it_was_cut_from() -> None:
    _, before, _, after = with_ends()
    assert after.parents.tolist() == [*before.parents.tolist(), 1]
    assert (after.shown, before.shown) == ((2,), ())
    assert not after.has_bones
    np.testing.assert_allclose(after.rest[2], [0.0, 0.0, END], atol=0.4)
    assert after.drift[2] < 0.01 * np.sqrt(aligned(turning()).area.sum())
    assert after.radius[2] == pytest.approx(1.0, rel=0.1)


def test_vertices_and_skin_go_with_the_new_part() -> None:
    before, _, x, after = with_ends()
    assert set(after.label) == {0, 1, 2}
    np.testing.assert_allclose(after.W.sum(axis=1), 1.0)
    np.testing.assert_array_equal(after.at_ends, before.V[:, 2] > 0.0)
    np.testing.assert_array_equal(after.end_x, x[:, after.at_ends])


def test_the_surface_beyond_the_joint_lies_on_the_frames() -> None:
    before, _, after, _ = with_ends()
    z, true = before.V[:, 2], Frames(turning()).true
    want = np.einsum("txy,vy->tvx", true.R[:, 2], before.V) + true.t[:, None, 2]
    tip = z > END + 0.5
    # about its own axis a round tube is free: its middle line tells
    middle = [x[:, tip].mean(axis=1) for x in (before.x, after, want)]
    assert np.linalg.norm(middle[1] - middle[2], axis=1).max() < 0.2
    assert np.linalg.norm(middle[0] - middle[2], axis=1).max() > 0.5
    np.testing.assert_array_equal(after[:, z < 0.0], before.x[:, z < 0.0])


def test_the_surface_is_not_torn_at_the_joint() -> None:
    before, _, after, tree = with_ends()
    edge = np.unique(np.sort(before.F[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)
    near = np.abs(before.V[edge, 2] - END).max(axis=1) < 1.5
    rest = np.linalg.norm(before.V[edge[near, 0]] - before.V[edge[near, 1]], axis=1)
    skin = np.einsum("vp,tpvx->tvx", tree.W, np.einsum("tpxy,vy->tpvx", tree.R, before.V) + tree.t[:, :, None])
    for x in (after, skin):
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
    surface, found, moved, after = extended(body)
    axis = [off(tree.R[:, 1], true.R[:, 1]) for tree in (found, after)]
    assert axis[0].max() > 10.0
    assert axis[1].max() < 5.0
    near = (surface.V[:, 2] > 0.5) & (surface.V[:, 2] < END - 0.7)
    want = np.einsum("txy,vy->tvx", true.R[:, 1], surface.V[near]) + true.t[:, 1, None]
    middle = [np.linalg.norm((x[:, near] - want).mean(axis=1), axis=1).max() for x in (surface.x, moved)]
    assert middle[1] < 0.4 * middle[0]


def turn_by_half(Q: np.ndarray) -> np.ndarray:
    return np.asarray(Rotation.from_rotvec(Rotation.from_matrix(Q).as_rotvec() / 2).as_matrix())


def off(R: np.ndarray, true: np.ndarray) -> np.ndarray:
    """(frame,) degrees between the tube's axis as two rotations turn it: it is free about itself."""
    return np.degrees(np.arccos(np.clip(np.einsum("tx,tx->t", R[:, :, 2], true[:, :, 2]), -1.0, 1.0)))


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


def test_where_it_is_not_asked_or_nothing_turns_the_body_stays_as_aligned() -> None:
    tree, derivation = whole(False)
    assert sum(kind == "joint" for kind in tree.kinds) == 1
    assert derivation.end_joints == ()
    assert sum(kind == "joint" for kind in whole(True, 0.0)[0].kinds) == 1


@pytest.mark.parametrize("root", [0, 1])
def test_a_part_of_the_trunk_is_two_and_its_limbs_hang_on_the_one_beyond(root: int) -> None:
    turn = turning()
    body, tree = trunk(turn, root)
    ones, surface = np.ones(body.x.shape[:2]), Frames(turn, 0.02).prepared(body.size)
    (found,) = joints_at_ends(body, tree, ones, surface, mirrored=MIRRORED)
    np.testing.assert_allclose(found.cut.centre, 0.0, atol=0.7)
    after = extended_tree(body, tree, [found], ones, 0.002)
    new = 2
    assert after.shown == (new,)
    assert after.parents.tolist() == [-1, 0, root, new, new]
    assert not after.has_bones
    z, label = body.V[:, 2], after.label
    assert z[label == new].max() < z[label == root].max()
    np.testing.assert_array_equal(after.at_ends, np.isin(tree.label, [root]))
    limbs = [after.place[2], after.place[3]]
    np.testing.assert_array_equal(after.rest[limbs], tree.rest[[2, 3]])
    np.testing.assert_array_equal(after.R[:, limbs], tree.R[:, [2, 3]])
    true = turn[:, 1]
    between = np.einsum("tyx,tyz->txz", after.R[:, new], after.R[:, after.parents[new]])
    angles = [np.degrees(np.arccos(np.clip((np.trace(Q, axis1=1, axis2=2) - 1) / 2, -1, 1))) for Q in (between, true)]
    assert np.abs(angles[0] - angles[1]).mean() < 3.0


def test_what_is_known_of_a_part_goes_with_it_where_the_order_changes() -> None:
    turn = turning()
    body, tree = trunk(turn)
    four = np.arange(4.0)
    tree = tree._replace(radius=1.0 + four, unexplained=np.tile(0.01 * (1.0 + four), (24, 1)), drift=0.001 * four)
    ones, surface = np.ones(body.x.shape[:2]), Frames(turn, 0.02).prepared(body.size)
    (found,) = joints_at_ends(body, tree, ones, surface, mirrored=MIRRORED)
    after = extended_tree(body, tree, [found], ones, 0.002)
    kept = after.place[1:]
    np.testing.assert_array_equal(after.radius[kept], tree.radius[1:])
    np.testing.assert_array_equal(after.unexplained[:, kept], tree.unexplained[:, 1:])
    (new,) = after.shown
    assert after.radius[new] == found.cut.radius
    for part in (0, new):
        np.testing.assert_array_equal(after.unexplained[:, part], found.residual)
    np.testing.assert_allclose(after.drift[1:], after.drift_at(after.rest)[1:])
    assert [bool(after._replace(label=np.array([k])).at_ends[0]) for k in range(5)] == [True, False, True, False, False]


@pytest.mark.parametrize("settings", [EvidentRingsSettings(least_score_in_trunk=9.0), EvidentRingsSettings(least_apart=9.0)])
def test_a_ring_across_the_trunk_must_be_clear_and_far_from_joints(settings: EvidentRingsSettings) -> None:
    turn = turning()
    body, tree = trunk(turn)
    shown = Frames(turn, 0.02).prepared(body.size)
    assert joints_at_ends(body, tree, np.ones(body.x.shape[:2]), shown, EndJointsSettings(settings), mirrored=MIRRORED) == []


def test_a_root_that_a_frame_shows_counts_only_with_the_part_above_the_ring() -> None:
    turn = turning()
    body, tree = trunk(turn)
    confidence = np.ones(body.x.shape[:2])
    confidence[np.ix_([10, 11], tree.label == 1)] = 0.1
    (found,) = joints_at_ends(body, tree, confidence, Frames(turn, 0.02).prepared(body.size), mirrored=MIRRORED)
    assert np.flatnonzero(~found.visible).tolist() == [10, 11]


def test_the_piece_where_the_root_lies_stays_the_root() -> None:
    """Beyond the ring, amid the limbs: the other piece and the part above hang on it."""
    turn = turning()
    body, tree = trunk(turn, place=LIMBS + 0.5)
    ones, surface = np.ones(body.x.shape[:2]), Frames(turn, 0.02).prepared(body.size)
    (found,) = joints_at_ends(body, tree, ones, surface, mirrored=MIRRORED)
    after = extended_tree(body, tree, [found], ones, 0.002)
    assert (after.parents.tolist(), after.shown) == ([-1, 0, 0, 0, 3], (3,))
    assert after.place.tolist() == [0, 4, 1, 2]
    z, label = body.V[:, 2], after.label
    assert z[label == 3].min() > z[label == 0].min()
    assert after.in_divided_trunk.tolist() == [False, False, False, True, True]
    root = np.einsum("txy,y->tx", after.R[:, 0], after.rest[0]) + after.t[:, 0]
    assert np.linalg.norm(root - after.rest[0], axis=1).max() < 0.1  # the lowest piece of the tube stays


def test_a_trunk_that_does_not_bend_stays_one() -> None:
    turn = turning()
    turn[:, 1] = np.eye(3)
    body, tree = trunk(turn)
    shown = Frames(turn, 0.02).prepared(body.size)
    assert joints_at_ends(body, tree, np.ones(body.x.shape[:2]), shown, mirrored=MIRRORED) == []
