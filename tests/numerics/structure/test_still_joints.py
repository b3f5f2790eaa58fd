"""A neck becomes a bone between its part and the part above."""

from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from bottles import BOTTOM, TOP, bottle, revolution
from scipy.spatial.transform import Rotation
from shapes import y_pipe
from shipped import TREE
from whole_tree import whole_tree

from kinetree.tasks.numerics.geometry.geodesic_distance import geodesic_distance
from kinetree.tasks.numerics.geometry.surface import Surface
from kinetree.tasks.numerics.structure import kinematic_tree as module
from kinetree.tasks.numerics.structure import posed_tree
from kinetree.tasks.numerics.structure.articulated_fit import Motion
from kinetree.tasks.numerics.structure.centre_lines import ExpectedJoints
from kinetree.tasks.numerics.structure.first_tree import FirstTree, PartGraph, in_tree_order
from kinetree.tasks.numerics.structure.kinematic_tree import Derivation, KinematicTree, kinematic_tree
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs
from kinetree.tasks.numerics.structure.necks import NecksSettings, necks, tubes
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.still_joints import PosedTree, Still, StillJoint, with_still_joints
from kinetree.tasks.numerics.structure.surface_joints import SurfaceJoints
from kinetree.tasks.numerics.structure.tree_joints import Cut, tree_joints


def nodding_cut(joint: float) -> tuple[MovingSurface, Cut, np.ndarray]:
    """A bottle of two rigid parts that turn by 40° about a point of its neck, in twelve frames; its cut and its tips."""
    V, F = bottle(3.0, 1.8)
    turn = Rotation.from_rotvec(np.radians(20.0) * np.stack([np.sin(np.arange(12.0)), *np.zeros((2, 12))], axis=1)).as_matrix()
    R = np.stack([np.tile(np.eye(3), (12, 1, 1)), turn], axis=1)
    c = np.array([0.0, 0.0, joint])
    t = np.stack([np.zeros((12, 3)), c - turn @ c], axis=1)
    return moving(V, F, (V[:, 2] > joint).astype(np.int64), R, t)


def moving(
    V: np.ndarray, F: np.ndarray, label: np.ndarray, R: np.ndarray, t: np.ndarray
) -> tuple[MovingSurface, Cut, np.ndarray]:
    """The surface in all frames, its cut and its tips."""
    x = np.einsum("tvxy,vy->tvx", R[:, label], V) + t[:, label]
    surface = MovingSurface(V, F, x, Surface.of(V, F).area)
    tips = np.array([V[:, 2].argmin(), V[:, 2].argmax()])
    return surface, Cut(V, label, R, t, np.zeros((len(R), R.shape[1]))), tips


BASE = TOP + NecksSettings().base
"""Height at which a part on the neck turns."""


def hanging_necks(V: np.ndarray, F: np.ndarray, tree: PosedTree) -> list[StillJoint]:
    return list(necks(tubes(V, F, tree.label, tree.parents, tree.radius), tree.motion.rest))


@cache
def nodding(joint: float, has_necks: bool) -> tuple[KinematicTree, Derivation]:
    surface, cut, tips = nodding_cut(joint)
    return whole_tree(surface, cut, tips, settings=TREE._replace(hidden_bones=False), has_necks=has_necks)


def posed(parents: list[int], heights: list[float], label: np.ndarray) -> PosedTree:
    """Two frames of a tree; what is known of the joint of part k is k, its rotation turns by k radians in the second frame."""
    k = np.arange(len(parents))
    rest = np.stack([0.0 * k, 0.0 * k, heights], axis=1)
    R = Rotation.from_rotvec(np.outer(np.concatenate([0.0 * k, k]), [1.0, 0.0, 0.0])).as_matrix().reshape(2, len(k), 3, 3)
    known = k.astype(np.float64)
    return PosedTree(
        np.array(parents), Motion(rest, R, np.zeros((2, 3))), label, np.eye(len(k))[label], np.tile(known, (2, 1)),
        known, k, known,
        np.where(k > 0, 1.0, 0.0), known, known, known, k, k, k, np.full(len(k), Still.NO),
    )  # fmt: skip


@pytest.mark.parametrize(("joint", "new", "moved_by"), [(BASE, 1, 0), (BOTTOM, 2, 1)])
def test_a_neck_moves_as_the_tube_did_and_what_is_known_stays_with_its_joint(joint: float, new: int, moved_by: int) -> None:
    V, F = bottle(3.0, 1.8)
    before = posed([-1, 0], [0.0, joint], (V[:, 2] > joint).astype(np.int64))
    after = with_still_joints(before, hanging_necks(V, F, before), Still.NECK)
    old = 3 - new
    assert after.parents.tolist() == [-1, 0, 1]
    assert after.still.tolist() == [Still.NECK if k == new else Still.NO for k in range(3)]
    np.testing.assert_allclose(after.motion.rest[old], before.motion.rest[1])
    np.testing.assert_array_equal(after.motion.R[:, 1], before.motion.R[:, moved_by])
    np.testing.assert_array_equal(after.motion.R[:, [0, 2]], before.motion.R)
    for name in ("drift", "residual", "offset", "hinge", "spread", "agreeing", "radius"):
        assert getattr(after, name)[old] == 1, name
    assert after.support.tolist() == [0, 1, 1]
    assert after.radius[new] == pytest.approx(1.0, rel=0.05)
    assert after.radius[new] != 1.0
    np.testing.assert_array_equal(after.confidence[0], [0.0, 1.0, 1.0])
    z = V[:, 2]
    assert set(after.label[(z > BOTTOM + 0.4) & (z < TOP - 0.4)]) == {1}
    np.testing.assert_allclose(after.W.sum(axis=1), 1.0)
    moved = np.einsum("vp,tpxy->tvxy", after.W, after.motion.R)
    np.testing.assert_allclose(moved, np.einsum("vp,tpxy->tvxy", before.W, before.motion.R), atol=1e-12)


def test_two_necks_on_one_body_each_get_their_skin() -> None:
    """Two bottles, the second beside the first: parts 1 and 2 are their heads."""
    (V, F), aside = bottle(3.0, 1.8), np.array([9.0, 0.0, 0.0])
    both, faces = np.concatenate([V, V + aside]), np.concatenate([F, F + len(V)])
    label = np.where(both[:, 2] > TOP, np.repeat([1, 2], len(V)), 0)
    before = posed([-1, 0, 0], [0.0, TOP, TOP], label)
    before.motion.rest[2] += aside
    hanging = hanging_necks(both, faces, before)
    after = with_still_joints(before, hanging, Still.NECK)
    assert after.parents.tolist() == [-1, 0, 1, 0, 3]
    assert after.place.tolist() == [0, 2, 4]
    assert after.carrier.tolist() == [0, 0, 1, 0, 2]
    tube = (both[:, 2] > BOTTOM + 0.4) & (both[:, 2] < TOP - 0.4)
    np.testing.assert_array_equal(after.label[tube], np.where(both[tube, 0] < 5.0, 1, 3))


def joint_heights(tree: KinematicTree) -> list[float]:
    return sorted(float(p[2]) for p, kind in zip(tree.rest, tree.kinds, strict=True) if kind == "joint")


@pytest.mark.parametrize(("joint", "free"), [(BOTTOM, BASE), (TOP, BOTTOM)])
def test_the_finished_body_has_a_joint_at_both_ends(joint: float, free: float) -> None:
    """Also where motion without any error has it beside its place."""
    tree, derivation = nodding(joint, True)
    assert joint_heights(tree) == pytest.approx(sorted([joint, free]), abs=0.2)
    (new,) = derivation.neck_joints
    assert tree.rest[new, 2] == pytest.approx(free, abs=0.2)
    assert (derivation.agreeing[new], np.isnan(derivation.spread[new])) == (1, True)


@pytest.mark.parametrize("joint", [BOTTOM, TOP])
def test_the_joint_that_turns_stays(joint: float) -> None:
    (one, _), (two, derivation) = nodding(joint, False), nodding(joint, True)
    turning = next(k for k, kind in enumerate(two.kinds) if kind == "joint" and k not in derivation.neck_joints)
    (before,) = (p for p, kind in zip(one.rest, one.kinds, strict=True) if kind == "joint")
    np.testing.assert_allclose(two.rest[turning], before)
    (new,) = derivation.neck_joints
    known = next(k for k, kind in enumerate(one.kinds) if kind == "joint")
    assert two.degrees[new] == pytest.approx(0.0, abs=1e-5)
    for name in ("degrees", "drift", "support"):
        assert getattr(two, name)[turning] == getattr(one, name)[known], name
    assert two.support[new] == two.support[turning]
    np.testing.assert_array_equal(two.confidence[:, new], one.confidence[:, known])


def compound_cut() -> tuple[MovingSurface, Cut, np.ndarray]:
    """Neck and head turn by 20° each, the aligned neck as the head does: the two parts turn about no point."""
    V, F = bottle(3.0, 1.8)
    time = np.arange(12.0)
    neck, head = (
        Rotation.from_rotvec(np.radians(20.0) * np.outer(wave, [1.0, 0.0, 0.0])).as_matrix()
        for wave in (np.sin(time), np.cos(time))
    )
    low, high = np.array([0.0, 0.0, BOTTOM]), np.array([0.0, 0.0, BASE])
    turn = neck @ head
    shift = low + neck @ (high - low) - turn @ high
    R = np.stack([np.tile(np.eye(3), (12, 1, 1)), turn], axis=1)
    return moving(V, F, (V[:, 2] > TOP - 0.8).astype(np.int64), R, np.stack([np.zeros((12, 3)), shift], axis=1))


def test_a_joint_that_stands_for_two_is_moved_to_one_of_them() -> None:
    settings = TREE._replace(hidden_bones=False)
    (alone, _), (both, derivation) = (whole_tree(*compound_cut(), settings=settings, has_necks=has) for has in (False, True))
    (between,) = joint_heights(alone)
    assert BOTTOM + 0.4 < between < BASE - 0.4
    assert joint_heights(both) == pytest.approx([BOTTOM, BASE], abs=0.2)
    assert len(derivation.neck_joints) == 1


@pytest.mark.parametrize(
    ("here", "unexplained", "there", "moves"),
    [(0.1, 0.0, 0.24, True), (0.1, 0.0, 0.26, False), (0.0, 0.1, 0.24, True), (0.0, 0.1, 0.26, False), (0.0, 0.0, 0.0, True)],
)
def test_motion_that_leaves_no_doubt_places_a_joint(here: float, unexplained: float, there: float, moves: bool) -> None:
    """The drift where motion has it, what that leaves unexplained, and the drift where the shape has it."""
    V, F = bottle(3.0, 1.8)
    hanging = tubes(V, F, (V[:, 2] > BOTTOM).astype(np.int64), np.array([-1, 0]), np.array([0.0, 1.0]))
    joints = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, BOTTOM + 1.0]])
    first: Any = SimpleNamespace(
        shown=(),
        residual=np.array([0.0, unexplained]),
        drift_at=lambda rest: np.array([0.0, here if rest is joints else there]),
    )
    rest, stays = posed_tree._on_tubes(first, hanging, joints)
    assert stays.tolist() == [False, moves]
    assert (rest[1, 2] != joints[1, 2]) == moves


@pytest.mark.parametrize(("astray", "has_necks"), [(True, True), (False, True), (False, False)])
def test_surfaces_do_not_move_a_joint_that_has_a_place_on_a_tube(
    astray: bool, has_necks: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: dict[str, Any] = {}

    def stay(*args: Any, held: Any, lines: Any, **_: Any) -> SurfaceJoints:
        asked.update(held=held, rest=args[2], lines=lines)
        return SurfaceJoints(args[2], *np.full((2, 2), np.nan))

    line = np.diag([0.0, 0.0, 1.0])
    monkeypatch.setattr(posed_tree, "surface_joints", stay)
    monkeypatch.setattr(posed_tree, "towards_centre_lines", lambda *args: ExpectedJoints(args[5], line[None]))
    surface, cut, tips = compound_cut() if astray else nodding_cut(BOTTOM)
    first = in_tree_order(tree_joints(surface, cut, tips, settings=TREE._replace(hidden_bones=False)), 2)
    laid: Any = object()
    kinematic_tree(surface, first, tips, laid=laid, has_necks=has_necks)
    assert asked["held"].tolist() == [False, has_necks]
    np.testing.assert_array_equal(asked["lines"], [0.0 * line, line])
    assert (asked["rest"] == first.rest).all() != astray


def test_lengths_are_held_and_weights_sum_to_one() -> None:
    tree, derivation = nodding(BOTTOM, True)
    (new,) = derivation.neck_joints
    length = np.linalg.norm(tree.positions[:, new] - tree.positions[:, tree.parents[new]], axis=1)
    np.testing.assert_allclose(length, length[0], rtol=1e-6)
    np.testing.assert_allclose(tree.weight.sum(axis=1), 1.0, rtol=1e-5)


def test_not_asked_for_there_is_none() -> None:
    tree, derivation = nodding(BOTTOM, False)
    assert (len(joint_heights(tree)), derivation.neck_joints) == (1, ())


@pytest.mark.parametrize("has_necks", [False, True])
def test_joints_that_surfaces_show_are_told_beside_a_neck(has_necks: bool) -> None:
    V, F = bottle(3.0, 1.8)
    low, time = float(V[:, 2].min()) + 2.0, np.arange(12.0)
    swing = np.radians(20.0) * np.stack([np.sin(time), np.cos(time)])
    about_x = [Rotation.from_rotvec(angle[:, None] * np.array([1.0, 0.0, 0.0])).as_matrix() for angle in swing]
    R = np.stack([np.tile(np.eye(3), (12, 1, 1)), *about_x], axis=1)
    rest = np.array([[0.0, 0.0, (low + TOP) / 2], [0.0, 0.0, TOP], [0.0, 0.0, low]])
    t = np.stack([rest[p] - R[:, p] @ rest[p] for p in range(3)], axis=1)
    label = np.where(V[:, 2] > TOP, 1, np.where(V[:, 2] < low, 2, 0))
    x = np.einsum("tvxy,vy->tvx", R[:, label], V) + t[:, label]
    none = np.zeros(0)
    graph = PartGraph(label, np.zeros((0, 2), np.int64), np.zeros((0, 3)), none, none, ())
    tree = FirstTree(
        parents=np.array([-1, 0, 0]), place=np.array([0, 1]), shown=(2,), label=label, W=np.eye(3)[label], R=R, t=t,
        certain_share=np.ones((12, 3)), rest=rest, drift=np.zeros(3), unexplained=np.full((12, 3), 0.01),
        radius=np.array([0.0, 1.0, 1.0]), end_x=x[:, label != 1], graph=graph,
    )  # fmt: skip
    tips = np.array([V[:, 2].argmin(), V[:, 2].argmax()])
    body = MovingSurface(V, F, x, Surface.of(V, F).area)
    made, derivation = kinematic_tree(body, tree, tips, np.full(x.shape[:2], 0.99), has_necks=has_necks)
    assert len(derivation.neck_joints) == has_necks
    assert made.rest[list(derivation.end_joints), 2] == pytest.approx([low], abs=0.1)


def test_necks_stay_necks_when_mirrored_joints_follow() -> None:
    V, F = bottle(3.0, 1.8)
    before = posed([-1, 0], [0.0, TOP], (V[:, 2] > TOP).astype(np.int64))
    neck = hanging_necks(V, F, before)
    once = with_still_joints(before, neck, Still.NECK)
    toe = StillJoint(2, False, np.array([0.0, 0.0, 9.0]), 0.5, (V[:, 2] < 9.0).astype(np.float64))
    both = with_still_joints(once, [toe], Still.MIRRORED)
    assert both.parents.tolist() == [-1, 0, 1, 2]
    assert both.still.tolist() == [*once.still.tolist(), Still.MIRRORED]
    np.testing.assert_allclose(both.motion.rest[3], toe.centre)
    np.testing.assert_array_equal(both.motion.R[:, 3], once.motion.R[:, 2])
    np.testing.assert_allclose(both.W.sum(axis=1), 1.0)


def test_a_leg_gets_ankle_and_toes_one_after_the_other() -> None:
    """The other leg has one joint more beyond its ankle."""
    cut, surface, leaves = legs()
    toes = PIPE @ ALONG > 24.5
    R, t = (np.concatenate([a, a[:, 2:3]], axis=1) for a in (cut.R, cut.t))
    joint = 24.5 * ALONG
    for f in range(len(R)):
        R[f, 4] = R[f, 2] @ Rotation.from_rotvec([0.0, 0.0, 0.5 * np.sin(2.0 * f)]).as_matrix()
        t[f, 4] = R[f, 2] @ joint + t[f, 2] - R[f, 4] @ joint
    label = np.where(toes, 4, cut.label)
    x = np.einsum("tvxy,vy->tvx", R[:, label], PIPE) + t[:, label]
    body, derivation = whole_tree(
        surface._replace(x=x), Cut(PIPE, label, R, t, np.zeros((24, 5))), leaves, np.ones(x.shape[:2]), settings=TREE,
        has_mirrored_joints=True,
    )  # fmt: skip
    found = sorted(body.rest[list(derivation.mirrored_joints)] @ (ALONG * [1.0, -1.0, 1.0]))
    np.testing.assert_allclose(found, [18.0, 24.5], atol=1.5)


def test_a_leg_gets_the_ankle_that_the_other_one_has_and_the_derivation_says_so() -> None:
    cut, surface, leaves = legs()
    trust = np.ones(surface.x.shape[:2])
    (plain, _), (body, derivation) = (
        whole_tree(surface, cut, leaves, trust, settings=TREE, has_mirrored_joints=has) for has in (False, True)
    )
    assert len(body.names) == len(plain.names) + 1
    (joint,) = derivation.mirrored_joints
    assert derivation.neck_joints == derivation.end_joints == ()
    assert body.kinds[joint] == "joint"
    assert body.degrees[joint] == 0.0
    ankle = next(j for j, kind in enumerate(body.kinds) if kind == "joint" and np.linalg.norm(body.rest[j] - ANKLE) < 2.0)
    assert ankle != joint
    np.testing.assert_allclose(body.rest[joint], ANKLE * [1.0, -1.0, 1.0], atol=1.5)
    assert np.isnan(derivation.spread[joint])
    np.testing.assert_allclose(body.weight.sum(axis=1), 1.0)
    hips = np.flatnonzero((body.parents == 0) & (derivation.partner > 0))
    assert {*derivation.partner.tolist()} == {-1, ankle, joint, *hips.tolist()}
    np.testing.assert_array_equal(derivation.partner[[ankle, joint, *hips]], [joint, ankle, *hips[::-1]])


def dumbbell(frames: int = 12) -> tuple[MovingSurface, Cut, np.ndarray]:
    """A trunk with a limb above and one below that narrow beyond their joints, both of which swing; and their ends."""
    limb = [(4.0, 3.0), (5.0, 2.0), (15.0, 1.0), (17.0, 1.7), (20.0, 1.7), (21.0, 0.4)]
    profile = [*((-z, r) for z, r in reversed(limb)), *limb]
    V, F = revolution([z for z, _ in profile], [r for _, r in profile])
    label = np.where(V[:, 2] > 5.0, 1, np.where(V[:, 2] < -5.0, 2, 0))
    R, t = np.tile(np.eye(3), (frames, 3, 1, 1)), np.zeros((frames, 3, 3))
    for part, (sign, phase) in enumerate(((1.0, 0.0), (-1.0, 1.0)), start=1):
        angle = np.radians(25.0) * np.sin(np.arange(frames) + phase)
        R[:, part] = Rotation.from_rotvec(np.outer(angle, [1.0, 0.0, 0.0])).as_matrix()
        t[:, part] = [0.0, 0.0, 5.0 * sign] - R[:, part] @ [0.0, 0.0, 5.0 * sign]
    surface, cut, _ = moving(V, F, label, R, t)
    return surface, cut, np.array([len(V) - 1, len(V) - 2])


def test_narrowings_of_both_limbs_are_joints_that_turn_by_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    surface, cut, tips = dumbbell()
    away = geodesic_distance(Surface.of(surface.V, surface.F), tips)
    both = LimbPairs(np.stack([tips, tips]), np.stack([away, away]))
    monkeypatch.setattr(module, "limb_pairs", lambda *of: both)
    trust = np.full(surface.x.shape[:2], 0.99)
    made = {
        has: whole_tree(surface, cut, tips, trust, settings=TREE, has_narrowings=has, has_mirrored_joints=True)
        for has in (False, True)
    }
    (plain, before), (body, derivation) = made[False], made[True]
    assert (before.narrowing_joints, len(derivation.narrowing_joints)) == ((), 2)
    assert derivation.mirrored_joints == derivation.neck_joints == before.mirrored_joints == ()
    assert len(body.names) == len(plain.names) + 2
    wrists = list(derivation.narrowing_joints)
    np.testing.assert_allclose(np.sort(body.rest[wrists, 2]), [-15.75, 15.75], atol=0.3)
    np.testing.assert_array_equal(body.degrees[wrists], 0.0)
    assert np.isnan(derivation.spread[wrists]).all()
    forearm = body.parents[wrists]
    np.testing.assert_array_equal(body.rotation[:, wrists], body.rotation[:, forearm])
    np.testing.assert_allclose(body.weight.sum(axis=1), 1.0)


PIPE, FACES, _ = y_pipe()
ALONG = np.array([-0.5, np.sqrt(0.75), 0.0])
"""Of the first leg; the other one has −y."""
ANKLE = 18.0 * ALONG


def legs() -> tuple[Cut, MovingSurface, np.ndarray]:
    """A pipe of three arms: both legs swing about hips at 6 from the fork, the foot of one about its ankle too.

    Its third arm ends at a head, and at a hand on either side, so that it has two pairs of limbs.
    """
    first = PIPE @ ALONG
    other = PIPE @ (ALONG * [1.0, -1.0, 1.0])
    label = np.where(first > 18.0, 2, np.where(first > 6.0, 1, np.where(other > 6.0, 3, 0)))
    R, t = np.tile(np.eye(3), (24, 4, 1, 1)), np.zeros((24, 4, 3))
    for f in range(24):
        swing = [Rotation.from_rotvec([0.0, 0.0, 0.4 * np.sin(f + k)]).as_matrix() for k in range(3)]
        R[f, 1], R[f, 3], R[f, 2] = swing[0], swing[1], swing[0] @ swing[2]
        hips = 6.0 * ALONG, 6.0 * ALONG * [1.0, -1.0, 1.0]
        t[f, 1], t[f, 3] = hips[0] - R[f, 1] @ hips[0], hips[1] - R[f, 3] @ hips[1]
        t[f, 2] = R[f, 1] @ ANKLE + t[f, 1] - R[f, 2] @ ANKLE
    x = np.einsum("tvxy,vy->tvx", R[:, label], PIPE) + t[:, label]
    surface = MovingSurface(PIPE, FACES, x, Surface.of(PIPE, FACES).area)
    hands = [int(np.argmin(np.linalg.norm(PIPE - [12.0, y, 0.0], axis=1))) for y in (4.0, -4.0)]
    leaves = np.array([first.argmax(), other.argmax(), PIPE[:, 0].argmax(), *hands])
    return Cut(PIPE, label, R, t, np.zeros((24, 4))), surface, leaves
