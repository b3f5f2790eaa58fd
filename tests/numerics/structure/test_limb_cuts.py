"""Rings across limbs that one part holds, and the legs of a body that bows."""

from functools import cache

import numpy as np
import pytest
from bow import FRAMES, HIP, KNEE, LEGS, PELVIS, SHANKS, SPINE, TIPS, TRUNK, bow, motions, pairs, shown

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.structure import shown_joints as numerics
from kinetree.tasks.numerics.structure.end_cuts import EndCut
from kinetree.tasks.numerics.structure.end_joints import EndJoint, _with_common_pieces, end_joints, judged_runs
from kinetree.tasks.numerics.structure.end_rings import EndFrames, end_rings, laid_in_runs
from kinetree.tasks.numerics.structure.extended_tree import extended_tree, moved_ends
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.limb_cuts import LimbCutsSettings, limb_cuts
from kinetree.tasks.numerics.structure.limb_pairs import NO_PAIRS, LimbPairs
from kinetree.tasks.numerics.structure.part_tree import MovingSurface

BODY, TREE = bow()
PAIRS = pairs()


def cuts(
    label: Ints = TREE.label,
    parents: Ints = TREE.parents,
    both: LimbPairs = PAIRS,
    settings: LimbCutsSettings | None = None,
    rest: Floats = TREE.rest,
) -> list[EndCut]:
    return list(limb_cuts(BODY.V, BODY.F, BODY.area, label, parents, rest, both, settings))


def test_rings_lie_in_twos_equally_far_from_both_ends() -> None:
    found = cuts()
    assert len(found) >= 10
    for one, other in zip(found[::2], found[1::2], strict=True):
        assert (one.part, one.above, one.hung) == (PELVIS, SHANKS[0], (SHANKS[1], TRUNK))
        assert (other.part, other.above, other.hung) == (PELVIS, SHANKS[1], (SHANKS[0], TRUNK))
        assert one.level == other.level
        assert one.is_across_limb
        np.testing.assert_allclose(one.centre * [1.0, -1.0, 1.0], other.centre, atol=0.3)
    inwards = [cut.centre @ LEGS[0] for cut in found[::2]]
    assert inwards == sorted(inwards, reverse=True)
    assert inwards[0] < KNEE
    assert min(abs(along - HIP) for along in inwards) < 0.7
    assert [cut.level for cut in found[::2]] == list(range(len(found) // 2))


def test_what_lies_before_the_other_ring_does_not_count() -> None:
    found = cuts()
    for one, other in zip(found[::2], found[1::2], strict=True):
        mine, others = one.own[~one.far], other.own[~other.far]
        assert not np.isin(mine, other.own).any()
        assert not np.isin(others, one.own).any()
        np.testing.assert_array_equal(one.own[one.far], other.own[other.far])
        every = np.concatenate([mine, others, one.own[one.far]])
        left = np.setdiff1d(np.flatnonzero(TREE.label == PELVIS), every)
        np.testing.assert_allclose(*PAIRS.distance[0][:, left])  # as far from one end as from the other, before both rings
        assert len(np.unique(every)) == len(every)


def test_how_far_rings_lie_from_joints_is_told() -> None:
    for cut in cuts():
        nearest = np.linalg.norm(TREE.rest[1:] - cut.centre, axis=1).min()
        assert cut.apart == pytest.approx(nearest / cut.radius)


def test_seen_from_the_pelvis_they_are_the_same() -> None:
    """The pelvis is the root, the trunk hangs on it."""
    label = np.array([1, 0, 2, 3])[TREE.label]
    found = cuts(label, np.array([-1, 0, 0, 0]), rest=TREE.rest[[1, 1, 2, 3]])
    assert {(cut.part, cut.above, cut.hung) for cut in found} == {(0, 2, (3, 1)), (0, 3, (2, 1))}
    for one, other in zip(found, cuts(), strict=True):
        np.testing.assert_array_equal(one.own, other.own)
        assert one.apart == pytest.approx(other.apart)


@pytest.mark.parametrize(("limb", "any_are"), [(0.37, True), (0.38, False)])
def test_how_much_of_the_part_each_limb_must_have(limb: float, any_are: bool) -> None:
    """Each has 0.376."""
    assert bool(cuts(settings=LimbCutsSettings(limb=limb))) == any_are


def test_a_part_with_a_fourth_neighbour_holds_no_limbs() -> None:
    """As a chest with a neck holds no arms."""
    tail = (TREE.label == PELVIS) & (BODY.V[:, 0] > -1.0) & (BODY.V[:, 2] > 2.0)
    assert tail.sum() > 4
    rest = np.append(TREE.rest, [[0.0, 0.0, 4.0]], axis=0)
    assert cuts(np.where(tail, 4, TREE.label), np.append(TREE.parents, PELVIS), rest=rest) == []


def test_limbs_that_end_in_the_part_or_have_no_mirror_image_are_not_held() -> None:
    assert cuts(np.minimum(TREE.label, 2), TREE.parents[:3], rest=TREE.rest[:3]) == []
    one_leg = np.where(TREE.label == SHANKS[1], PELVIS, TREE.label)
    assert cuts(one_leg, TREE.parents[:3], rest=TREE.rest[:3]) == []
    assert cuts(both=NO_PAIRS) == []


def test_a_limb_with_two_ends_is_one_limb() -> None:
    """As a foot with heel and toe, both of which have a mirror image."""
    twice = LimbPairs(np.repeat(PAIRS.tip, 2, axis=0), np.repeat(PAIRS.distance, 2, axis=0))
    assert len(cuts(both=twice)) == len(cuts()) > 0


def test_a_body_with_a_single_pair_of_limbs_has_none() -> None:
    assert cuts(both=LimbPairs(PAIRS.tip[:1], PAIRS.distance[:1])) == []


def test_vertices_that_no_path_reaches_do_not_count() -> None:
    far, lost = PAIRS.distance.copy(), np.flatnonzero(TREE.label == PELVIS)[:3]
    far[:, :, lost] = np.inf
    found = cuts(both=LimbPairs(PAIRS.tip, far))
    assert len(found) == len(cuts())
    assert not any(np.isin(lost, cut.own).any() for cut in found)
    assert cuts(both=LimbPairs(PAIRS.tip, np.full_like(far, np.inf))) == []


def test_a_part_without_vertices_or_with_one_neighbour_less_holds_none() -> None:
    assert cuts(np.where(TREE.label == PELVIS, TRUNK, TREE.label)) == []
    only_legs = np.where(TREE.label == TRUNK, PELVIS, TREE.label) - 1
    assert cuts(only_legs, np.array([-1, 0, 0]), rest=TREE.rest[1:]) == []


def test_hips_that_lie_unequally_far_from_their_ends_get_rings_beyond_both() -> None:
    """The second knee lies four farther up."""
    along = BODY.V @ LEGS[1]
    label = np.where((TREE.label == PELVIS) & (along > KNEE - 4.0), SHANKS[1], TREE.label)
    found = cuts(label)
    assert len(found) >= 8
    assert max(float(cut.centre @ LEGS.T[:, 0]) for cut in found[::2]) < KNEE - 4.0
    assert all((~cut.far).any() and cut.far.any() for cut in found)


def extended(of_pelvis: float, monkeypatch: pytest.MonkeyPatch) -> tuple[MovingSurface, FirstTree]:
    """The body that bows, with the joints that the frames show; the ends of the legs are a pair."""
    body, tree = bow(of_pelvis)
    ones, surface = np.ones(body.x.shape[:2]), cache(shown(of_pelvis))
    monkeypatch.setattr(numerics, "limb_pairs", lambda *of: PAIRS)
    rings = end_rings(body.V, body.F, body.area, tree, np.isin(np.arange(4), SHANKS), PAIRS)
    frames = EndFrames.of(tree, body.area, np.arange(FRAMES), ones, surface)
    fits = laid_in_runs(frames, judged_runs(FRAMES, None), rings)
    return body, numerics.with_end_joints(body, tree, TIPS, fits, surface, ones, 0.01)


def test_legs_of_a_body_that_bows_are_cut_off_at_the_hips(monkeypatch: pytest.MonkeyPatch) -> None:
    body, tree = extended(18.0, monkeypatch)
    thighs = list(tree.shown)
    assert len(thighs) == 2
    assert len(tree.parents) == 6
    pelvis = {int(p) for p in tree.parents[thighs]}.pop()
    assert tree.parents[pelvis] == TRUNK
    np.testing.assert_allclose(tree.rest[thighs], HIP * LEGS[::-1], atol=0.5)
    shanks = tree.place[list(SHANKS)]
    assert tree.parents[shanks].tolist() == thighs[::-1]
    along = (body.V[np.isin(tree.label, thighs)] @ LEGS.T).max(axis=1)
    assert HIP - 1.5 < along.min() < HIP + 0.5
    assert body.V[tree.label == pelvis, 0].max() < SPINE + 0.5


def test_the_pelvis_moves_as_in_the_frames_then_and_its_joint_is_the_spine(monkeypatch: pytest.MonkeyPatch) -> None:
    _, tree = extended(18.0, monkeypatch)
    pelvis = int(tree.parents[tree.shown[0]])
    np.testing.assert_allclose(tree.rest[pelvis], [SPINE, 0.0, 0.0], atol=0.6)
    assert tree.drift[pelvis] < 0.15
    np.testing.assert_allclose(tree.drift[1:], tree.drift_at(tree.rest)[1:])
    R, _ = motions(18.0)
    off = np.einsum("tyx,tyz->txz", R[:, 1], tree.R[:, pelvis])
    angles = np.degrees(np.arccos(np.clip((np.trace(off, axis1=1, axis2=2) - 1) / 2, -1, 1)))
    assert angles.mean() < 2.0


def test_both_thighs_get_skin_that_is_a_mirror_image(monkeypatch: pytest.MonkeyPatch) -> None:
    """What lies beyond both rings is moved once: moved twice, skin at one hip would follow the pelvis alone."""
    body, tree = extended(18.0, monkeypatch)
    for distance in (-1.0, 0.0, 0.5, 1.0):
        near = [np.abs(body.V @ leg - (HIP - distance)) < 0.3 for leg in LEGS]
        weight = [float(tree.W[v, part].mean()) for v, part in zip(near, tree.shown[::-1], strict=True)]
        assert weight[0] == pytest.approx(weight[1], abs=0.1)


def test_a_vertex_that_follows_the_part_by_half_goes_half_of_the_way() -> None:
    body, tree = bow()
    tree = tree._replace(W=np.where(tree.W > 0.0, 0.5, 0.0))
    both = legs_of(body, tree)
    moved = moved_ends(body, tree, both)
    shared = np.intersect1d(both[0].cut.own[both[0].cut.share == 1.0], both[1].cut.own[both[1].cut.share == 1.0])
    assert len(shared) > 20
    for f in (3, 9):
        carried = body.V[shared] @ both[0].R[f, 1].T + both[0].t[f, 1]
        np.testing.assert_allclose(moved[f, shared], (body.x[f, shared] + carried) / 2.0, atol=1e-9)


def legs_of(body: MovingSurface, tree: FirstTree) -> list[EndJoint]:
    """Both legs of a body that bows."""
    ones, surface = np.ones(body.x.shape[:2]), cache(shown(18.0))
    rings = end_rings(body.V, body.F, body.area, tree, np.isin(np.arange(4), SHANKS), PAIRS)
    frames = EndFrames.of(tree, body.area, np.arange(FRAMES), ones, surface)
    fits = laid_in_runs(frames, judged_runs(FRAMES, None), rings)
    return [one for one in end_joints(frames, rings, fits) if one.cut.is_across_limb]


def test_the_pelvis_moves_as_the_clearer_ring_has_it_or_as_the_other_where_that_is_hidden() -> None:
    both = legs_of(*bow())
    np.testing.assert_array_equal(both[0].R[:, 1], both[1].R[:, 1])
    np.testing.assert_array_equal(both[0].residual, both[1].residual)
    one, other = (joint._replace(R=joint.R.copy(), t=joint.t.copy()) for joint in both)
    one.R[:, 1], other.R[:, 1], other.t[:, 1] = np.eye(3), -np.eye(3), 7.0
    hidden = np.arange(FRAMES) == 9
    again = _with_common_pieces([one, other._replace(visible=~hidden)])
    for joint, before in zip(again, (one, other), strict=True):
        np.testing.assert_array_equal(joint.R[hidden, 1], one.R[hidden, 1])
        np.testing.assert_array_equal(joint.R[~hidden, 1], other.R[~hidden, 1])
        np.testing.assert_array_equal(joint.t[hidden, 1], one.t[hidden, 1])
        np.testing.assert_array_equal(joint.t[~hidden, 1], other.t[~hidden, 1])
        np.testing.assert_array_equal(joint.residual, np.where(hidden, one.residual, other.residual))
        np.testing.assert_array_equal(joint.R[:, 0], before.R[:, 0])
    apart = [one, other._replace(cut=other.cut._replace(level=-1)), one._replace(cut=one.cut._replace(part=9))]
    for joint, before in zip(_with_common_pieces(apart), apart, strict=True):
        np.testing.assert_array_equal(joint.R, before.R)


def test_legs_are_cut_off_a_pelvis_that_is_the_root_and_other_parts_are_divided_with_it() -> None:
    """The trunk, part 1, carries two parts more, 4 and 5."""
    body, tree = bow()
    both, order = legs_of(body, tree), np.array([1, 0, 2, 3])
    label = order[tree.label]
    label = np.where((label == 1) & (body.V[:, 0] > 18.0), np.where(body.V[:, 1] > 0.0, 4, 5), label)
    of = np.array([1, 0, 2, 3, 0, 0])
    turned = tree._replace(
        parents=np.array([-1, 0, 0, 0, 1, 1]), place=np.arange(6), label=label, W=np.eye(6)[label], R=tree.R[:, of],
        t=tree.t[:, of], rest=np.concatenate([tree.rest[[1, 1, 2, 3]], [[18.0, 2.0, 0.0], [18.0, -2.0, 0.0]]]),
        certain_share=np.ones((FRAMES, 6)), drift=np.zeros(6), unexplained=np.full((FRAMES, 6), 0.05),
        radius=np.array([0.0, 3.0, 3.0, 3.0, 2.0, 2.0]),
    )  # fmt: skip
    legs = [one._replace(cut=one.cut._replace(part=0, hung=(one.cut.hung[0], 1))) for one in both]
    foot = np.flatnonzero(label == 2)
    toe = EndCut(2, 0, 22.0 * LEGS[0], 3.0, foot, (body.V[foot] @ LEGS[0]) - 22.0)
    pose = np.tile(np.eye(3), (FRAMES, 2, 1, 1)), np.zeros((FRAMES, 2, 3))
    end = EndJoint(toe, *pose, np.zeros(FRAMES), np.zeros(FRAMES, np.bool_), 0.1)
    after = extended_tree(body, turned, [end, *legs], np.ones(body.x.shape[:2]), 0.01)
    trunk, shanks, others = after.place[1], after.place[2:4], after.place[4:]
    thighs = after.parents[shanks]
    assert np.flatnonzero(after.parents == 0).tolist() == sorted([trunk, *thighs])
    assert after.parents[others].tolist() == [trunk, trunk]
    toes = next(k for k in after.shown if k not in thighs)
    assert after.parents[toes] == shanks[0]
    assert sorted(after.shown) == sorted([*thighs.tolist(), toes])
    np.testing.assert_allclose(after.rest[trunk], [SPINE, 0.0, 0.0], atol=0.8)
    np.testing.assert_allclose(after.rest[0], after.rest[thighs].mean(axis=0), err_msg="the root lies amid both hips")
    assert {*np.unique(after.label).tolist()} == {*range(9)}


def test_legs_that_do_not_turn_against_the_pelvis_stay_with_it(monkeypatch: pytest.MonkeyPatch) -> None:
    _, tree = extended(0.0, monkeypatch)
    assert tree.shown == ()
    np.testing.assert_array_equal(tree.rest, TREE.rest)
