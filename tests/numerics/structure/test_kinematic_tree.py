"""The finished body."""

from typing import Any

import numpy as np
import pytest
import trimesh
from articulated import ALL_STAY, Known, chain, moved, swings, three_arms
from fleshy_legs import pairs, seen
from legs import ALONG
from limbs import bent, rotation
from shipped import PARTS, TREE
from whole_tree import whole_tree

from kinetree.tasks.numerics.structure import kinematic_tree as numerics
from kinetree.tasks.numerics.structure import posed_tree
from kinetree.tasks.numerics.structure.first_tree import FirstTree, in_tree_order
from kinetree.tasks.numerics.structure.kinematic_tree import Derivation, KinematicTree, kinematic_tree
from kinetree.tasks.numerics.structure.limb_pairs import NO_PAIRS
from kinetree.tasks.numerics.structure.necks import Tube
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.rigid_parts import rigid_parts
from kinetree.tasks.numerics.structure.surface_joints import SurfaceJoints
from kinetree.tasks.numerics.structure.tree_joints import Cut, KinematicTreeSettings, tree_joints


def both(
    body: Known,
    leaves: tuple[int, ...] = (),
    confidence: np.ndarray | None = None,
    settings: KinematicTreeSettings = TREE,
    has_second_ends: bool = False,
) -> tuple[KinematicTree, Derivation]:
    tips = np.array(leaves, dtype=np.int64)
    return whole_tree(*known(body), tips, confidence, settings=settings, has_second_ends=has_second_ends)


def known(body: Known) -> tuple[MovingSurface, Cut]:
    """The body in motion, and its true parts."""
    return MovingSurface(body.V, body.F, body.x, body.area), Cut(body.V, body.label, body.R, body.t, body.residual)


def of(body: Known, leaves: tuple[int, ...] = (), confidence: np.ndarray | None = None) -> KinematicTree:
    return both(body, leaves, confidence)[0]


def ways(body: Known) -> np.ndarray:
    """(frame, part, xyz) where the true joints go."""
    above = np.maximum(body.parents, 0)
    return np.einsum("tpxy,py->tpx", body.R[:, above], body.joints) + body.t[:, above]


@pytest.mark.parametrize("blend", [0.0, 1.0])
def test_joints_of_a_chain_are_where_they_are_in_every_frame(blend: float) -> None:
    body = chain((-2.0, 2.0), blend=blend)
    found = of(body)
    turning = [j for j, kind in enumerate(found.kinds) if kind == "joint"]
    assert len(turning) == 2
    for j in turning:
        away = np.linalg.norm(ways(body)[:, 1:] - found.positions[:, j, None], axis=2)
        assert away.mean(axis=0).min() < 0.05
    assert found.kinds.count("leaf") == 2
    assert found.confidence.min() > 0.95
    assert found.degrees[turning].min() > 40


def test_every_joint_goes_where_its_parent_carries_it() -> None:
    found = of(three_arms())
    for j in range(1, len(found.names)):
        p = found.parents[j]
        carried = found.positions[:, p] + found.rotation[:, p] @ (found.rest[j] - found.rest[p])
        assert found.positions[:, j] == pytest.approx(carried, abs=1e-9)
    bones = np.linalg.norm(found.positions[:, 1:] - found.positions[:, found.parents[1:]], axis=2)
    assert np.ptp(bones, axis=0) == pytest.approx(0, abs=1e-9)


def test_skin_follows_the_joints() -> None:
    body = chain((-2.0, 2.0), blend=1.0)
    found = of(body)
    moved = np.einsum("tvkab,vkb->tvka", found.rotation[:, found.influence], body.V[:, None] - found.rest[found.influence])
    x = np.einsum("vk,tvka->tva", found.weight, moved + found.positions[:, found.influence])
    assert np.linalg.norm(x - body.x, axis=2).mean() < 0.05
    assert (found.label == -1).any()
    assert set(found.label) - {-1} == {j for j, kind in enumerate(found.kinds) if kind != "leaf"}


def test_stiff_body_is_one_root_and_has_no_joint() -> None:
    body = chain((0.0,), np.tile(np.eye(3), (12, 2, 1, 1)))
    found = of(body)
    assert found.names == ("root",)
    assert found.kinds == ("root",)
    assert set(found.label) == {0}
    one = body._replace(label=np.zeros(len(body.V), np.int64), R=body.R[:, :1], t=body.t[:, :1])
    assert of(one, leaves=(3,)).names == ("root", "root_end")


def test_noise_at_every_vertex_moves_no_joint_by_half_a_percent() -> None:
    body = chain((-2.0, 2.0), blend=1.0)
    rough = body.x + 0.00067 * 10.0 * np.random.default_rng(0).normal(size=body.x.shape)
    joints = []
    for x in (body.x, rough):
        p = rigid_parts(x[0], body.F, x, settings=PARTS)
        no_leaf = np.zeros(0, dtype=np.int64)
        cut = Cut(x[0], p.label, p.R, p.t, p.residual)
        found = whole_tree(MovingSurface(x[0], body.F, x, body.area), cut, no_leaf, settings=TREE)[0]
        joints.append(found.positions[:, [kind == "joint" for kind in found.kinds]])
    assert joints[0].shape == joints[1].shape == (24, 2, 3)
    assert np.linalg.norm(joints[0] - joints[1], axis=2).mean(axis=0).max() < 0.005 * 10.0


def test_body_turns_and_moves_as_a_whole_with_space() -> None:
    body = three_arms()
    Q, shift = rotation((1.0, -2.0, 0.5), 0.7), np.array([3.0, 50.0, -8.0])
    other = body._replace(x=body.x @ Q.T + shift, R=Q @ body.R, t=body.t @ Q.T + shift)
    one, two = of(body), of(other)
    assert two.names == one.names
    assert two.rest == pytest.approx(one.rest, abs=1e-6)
    assert two.positions == pytest.approx(one.positions @ Q.T + shift, abs=1e-4)


def test_names_and_joints_do_not_depend_on_the_order_of_vertices() -> None:
    body = three_arms()
    order = np.random.default_rng(4).permutation(len(body.V))
    rank = np.argsort(order)
    other = body._replace(V=body.V[order], F=rank[body.F], x=body.x[:, order], label=body.label[order], W=body.W[order])
    one, two = of(body), of(other)
    assert two.names == one.names
    joints = [j for j, kind in enumerate(one.kinds) if kind != "leaf"]
    assert two.positions[:, joints] == pytest.approx(one.positions[:, joints], abs=1e-4)


def test_vertices_without_a_part_and_parts_without_vertices_do_no_harm() -> None:
    body = chain((0.0,))
    label = np.where(np.arange(len(body.V)) % 11 == 0, -1, 2 * body.label)
    R, t = (np.stack([a[:, 0], a[:, 0], a[:, 1]], axis=1) for a in (body.R, body.t))
    found = of(body._replace(label=label, R=R, t=t))
    assert found.kinds.count("joint") == 1
    assert of(body._replace(label=np.full(len(body.V), -1), R=R, t=t)).names == ("root",)


def test_part_not_seen_in_one_frame_has_no_confidence_there_and_no_other_joint() -> None:
    body = chain((0.0,), swings(16, 2))
    confidence = np.ones(body.x.shape[:2])
    confidence[5, body.label == 1] = 0.0
    found = of(body, confidence=confidence)
    assert found.support.min() == 15
    assert found.confidence[5].min() < 0.1
    assert found.rest[1] == pytest.approx(of(body).rest[1], abs=1e-3)


@pytest.mark.parametrize("leaves", [(), (0,)])
def test_a_ring_with_no_leaf_or_one_has_one_tree(leaves: tuple[int, ...]) -> None:
    ring = trimesh.creation.torus(3.0, 0.8, major_sections=48, minor_sections=16)
    V, F, tips = np.array(ring.vertices), np.array(ring.faces), np.array(leaves, dtype=np.int64)
    x = np.stack([bent(V[:, [2, 1, 0]], 0.2 * f, 0.5)[:, [2, 1, 0]] for f in range(5)])
    held = rigid_parts(V, F, x, leaves=tips, settings=PARTS)
    cut = Cut(V, held.label, held.R, held.t, held.residual)
    found = whole_tree(MovingSurface(V, F, x, np.ones(len(V))), cut, tips, settings=TREE)[0]
    assert (found.parents < 0).sum() == 1
    assert found.kinds.count("joint") >= 1
    assert found.kinds.count("joint") + found.kinds.count("leaf") + 1 == len(found.kinds)
    assert np.isfinite(found.positions).all()


def test_parts_become_joints_and_what_was_dropped_has_none() -> None:
    turn = swings(24, 3)
    turn[:, 2] = np.eye(3)
    body = chain((-1.0, 2.0), turn)
    found, derivation = both(body)
    (dropped,) = derivation.dropped
    assert dropped.reason == "still"
    assert dropped.part in (1, 2)
    left = [p for p in range(3) if p != dropped.part]
    assert derivation.joint_of_part[dropped.part] == -1
    assert sorted(derivation.joint_of_part[left]) == [j for j, kind in enumerate(found.kinds) if kind != "leaf"]
    for part in left:
        assert found.rotation[:, derivation.joint_of_part[part]] == pytest.approx(body.R[:, part], abs=1e-3)


def test_graph_of_parts_is_that_before_any_was_dropped() -> None:
    body = three_arms()
    _, derivation = both(body)
    assert derivation.pair.tolist() == [[0, 1], [0, 2], [0, 3]]
    assert np.linalg.norm(derivation.centre - body.joints[1:], axis=1).max() < 1.0
    assert derivation.border_drift.max() < 0.01
    assert np.isfinite(derivation.border_degrees).all()


def test_ring_of_parts_has_one_border_outside_the_spanning_tree() -> None:
    body = three_arms()
    around = np.where(body.label == 0, (body.V @ body.joints[1:].T).argmax(axis=1), body.label - 1)
    t = body.t[:, 1:].copy()
    t[:, 2] += np.array([3.0, 1.0, 0.0])[:, None].T * np.sin(np.arange(len(t)))[:, None]
    _, derivation = both(body._replace(label=around, R=body.R[:, 1:], t=t))
    assert derivation.pair.tolist() == [[0, 1], [0, 2], [1, 2]]
    assert np.isnan(derivation.border_degrees).sum() == 1
    assert np.isfinite(derivation.border_degrees[0])


def test_parts_without_vertices_keep_their_numbers_and_are_not_dropped() -> None:
    body = chain((0.0,))
    R, t = (np.stack([a[:, 0], a[:, 0], a[:, 1]], axis=1) for a in (body.R, body.t))
    _, derivation = both(body._replace(label=2 * body.label, R=R, t=t))
    assert derivation.pair.tolist() == [[0, 2]]
    assert derivation.joint_of_part[1] == -1
    assert derivation.joint_of_part[[0, 2]].min() == 0
    assert derivation.dropped == ()


def test_lengths_before_they_are_held_are_those_of_bones_that_parts_share() -> None:
    found, derivation = both(three_arms())
    bones = [j for j, kind in enumerate(found.kinds) if kind == "joint"]
    assert derivation.free_length[bones] == pytest.approx(12, abs=1.0)
    assert derivation.free_deviation.max() < 0.005 * 12
    assert derivation.free_length[0] == 0.0


def test_a_last_part_that_forks_has_a_second_end_where_asked_for() -> None:
    arms = three_arms()
    longer = arms.V + np.maximum(arms.V[:, :1] - 12.0, 0.0) * [4.0, 0.0, 0.0]  # so that the fork is not the root
    fork = moved(longer, arms.F, np.eye(2)[np.where(arms.label == 1, 0, 1)], arms.joints[:2], np.array([-1, 0]), swings(24, 2))
    prong = int(np.argmin(arms.V[:, 1]))
    ends = [both(fork, (prong,), has_second_ends=s)[0].names for s in (False, True)]
    assert ends == [("root", "limb_a_1", "limb_a_end"), ("root", "limb_a_1", "limb_a_end_1", "limb_a_end_2")]


def test_root_amid_its_limbs_moves_no_other_joint(monkeypatch: pytest.MonkeyPatch) -> None:
    body = three_arms()
    place = np.array([1.0, -2.0, 0.5])
    monkeypatch.setattr("kinetree.tasks.numerics.structure.tree_joints.root_amid_limbs", lambda *_: place)
    before, after = (both(body, (), None, TREE._replace(root_amid_limbs=s))[0] for s in (False, True))
    assert np.linalg.norm(before.rest[0] - place) > 1.0
    np.testing.assert_allclose(after.rest[0], place)
    np.testing.assert_allclose(after.positions[:, 1:], before.positions[:, 1:], atol=1e-6)


def in_pose(body: Known, k: int) -> Cut:
    """The true parts as a cut in the pose of a frame gives them."""
    R = np.einsum("tpxy,pzy->tpxz", body.R, body.R[k])
    return Cut(body.x[k], body.label, R, body.t - np.einsum("tpxy,py->tpx", R, body.t[k]), body.residual)


def shifted(cut: Cut, part: int, by: np.ndarray) -> Cut:
    """The cut with a part whose motion is off by a shift that goes with it: its joint lies elsewhere."""
    t = cut.t.copy()
    t[:, part] += cut.R[:, part] @ by - by
    return cut._replace(t=t)


def test_cuts_in_other_poses_that_agree_change_nothing_and_have_no_spread() -> None:
    body = chain((0.0,), swings(16, 2))
    alone, lone = whole_tree(*known(body), np.zeros(0, int), settings=TREE)
    found, told = whole_tree(*known(body), np.zeros(0, int), settings=TREE, further=[in_pose(body, k) for k in (3, 9)])
    size = np.sqrt(body.area.sum())
    assert found.names == alone.names
    assert found.rest == pytest.approx(alone.rest, abs=0.01 * size)
    turning = np.array(found.kinds) == "joint"
    assert told.agreeing[turning].tolist() == [3]
    assert told.spread[turning].max() < 0.01 * size
    assert lone.agreeing[turning].tolist() == [1]
    assert np.isnan(lone.spread).all()
    assert np.isnan(told.spread[~turning]).all()


def test_a_cut_that_places_a_joint_elsewhere_moves_it_half_way_and_is_its_spread() -> None:
    body = chain((0.0,), swings(16, 2))
    size, turning = np.sqrt(body.area.sum()), 1
    same, _ = whole_tree(*known(body), np.zeros(0, int), settings=TREE, further=[in_pose(body, 3)])
    off = shifted(in_pose(body, 3), 1, np.array([0.0, 0.0, 0.02 * size]))
    found, told = whole_tree(*known(body), np.zeros(0, int), settings=TREE, further=[off])
    moved_by = np.linalg.norm(found.rest[turning] - same.rest[turning])
    assert 0.002 * size < moved_by < 0.02 * size
    assert told.spread[turning] == pytest.approx(moved_by, rel=0.3)


def forked(at: np.ndarray, apart: np.ndarray, noise: np.ndarray) -> tuple[MovingSurface, FirstTree, np.ndarray]:
    """Three arms, two of which turn about places beside `at`, with noise in where these two are; and their places in the tree.

    apart : (arm, xyz) of these places from `at`, noise : (frame,)
    """
    arms = three_arms(reach=4.0)
    joints = np.array([[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], *(at + apart)])
    surface, cut = known(moved(arms.V, arms.F, arms.W, joints, arms.parents, np.resize(swings(24, 4), (len(noise), 4, 3, 3))))
    first = in_tree_order(tree_joints(surface, cut, np.zeros(0, np.int64), settings=ALL_STAY), 4)
    places, t = first.place[[2, 3]], first.t.copy()
    t[:, places] += noise[:, None, None] * np.random.default_rng(0).normal(size=(len(noise), 2, 3))
    return surface, first._replace(t=t), places


def near(found: KinematicTree, place: np.ndarray) -> list[int]:
    """The joints that lie near a place."""
    return np.flatnonzero(np.linalg.norm(found.rest - place, axis=1) < 1.0).tolist()


@pytest.mark.parametrize("laid", [False, True])
def test_bones_of_one_joint_begin_in_one_place_in_every_frame(laid: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two arms turn about one point, and each one's joint is found along its arm, with noise that tells neither wrong."""
    asked: dict[str, Any] = {}

    def stay(*args: Any, held: Any, **_: Any) -> SurfaceJoints:
        asked["held"] = held
        return SurfaceJoints(args[2], *np.full((2, 4), np.nan))

    monkeypatch.setattr(posed_tree, "surface_joints", stay)
    at = np.array([-3.0, 0.0, 0.0])
    surface, first, arms = forked(at, np.zeros((2, 3)), np.full(24, 0.3))
    rest = first.rest.copy()
    rest[arms] = at + np.array([[-0.3, 0.5, 0.0], [-0.3, -0.5, 0.0]])
    parts: Any = object() if laid else None
    found, _ = kinematic_tree(surface, first._replace(rest=rest), np.zeros(0, np.int64), laid=parts)
    assert not laid or set(np.flatnonzero(asked["held"])) == set(arms)
    one, other = near(found, at)
    np.testing.assert_array_equal(found.positions[:, one], found.positions[:, other])
    rest[arms] = found.rest[[one, other]]
    drift = first.drift_at(rest)[arms]
    np.testing.assert_allclose(sorted(found.drift[[one, other]]), sorted(drift), err_msg="drift where the joints were moved to")
    assert not np.isclose(sorted(drift), sorted(first.drift[arms])).all()


def test_bones_whose_joints_one_take_tells_apart_do_not_begin_in_one_place() -> None:
    """Three other takes are so noisy that over all frames one place would do."""
    at, apart = np.array([-3.0, 0.0, 0.0]), np.array([[0.0, 0.6, 0.0], [0.0, -0.6, 0.0]])
    surface, first, _ = forked(at, apart, np.repeat([0.01, 1.0, 1.0, 1.0], 24))
    takes = [slice(24 * k, 24 * (k + 1)) for k in range(4)]
    as_one, told_apart = (kinematic_tree(surface._replace(takes=t), first, np.zeros(0, np.int64))[0] for t in (None, takes))
    one, other = near(as_one, at)
    np.testing.assert_array_equal(as_one.rest[one], as_one.rest[other])
    one, other = near(told_apart, at)
    assert np.linalg.norm(told_apart.rest[one] - told_apart.rest[other]) > 1.0


def test_a_part_whose_joint_has_a_mirror_image_is_no_head(monkeypatch: pytest.MonkeyPatch) -> None:
    """All last parts hang on tubes here; both shanks are each other's mirror images, the chest is a head then."""
    body, tree = seen()
    last = np.setdiff1d(np.arange(1, len(tree.parents)), tree.parents).tolist()
    hanging = [Tube(part, np.zeros((2, 3)), 1.0, np.zeros(len(body.V))) for part in last]
    monkeypatch.setattr(numerics, "tubes", lambda *of: hanging)
    shanks = {int(tree.label[np.argmax(along)]) for along in ALONG.values()}
    assert [tube.part for tube in numerics._heads(body, tree, NO_PAIRS)] == last
    assert {tube.part for tube in numerics._heads(body, tree, pairs())} == {*last} - shanks
    assert len(shanks) == 2
    assert len(last) == 3
