"""Rings across limbs that one part holds, and the legs of a body that bows."""

from functools import cache

import numpy as np
import pytest
from bow import FRAMES, HIP, KNEE, LEGS, PELVIS, SHANKS, SPINE, TIPS, TRUNK, bow, motions, pairs, shown

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.structure import extended_tree as numerics
from kinetree.tasks.numerics.structure.end_cuts import EndCut
from kinetree.tasks.numerics.structure.end_joints import judged_runs
from kinetree.tasks.numerics.structure.end_rings import EndFrames, end_rings, laid_in_runs
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
    assert len(cuts(both=twice)) == len(cuts())


def test_a_limb_that_no_path_reaches_is_not_held() -> None:
    far = PAIRS.distance.copy()
    far[:, :, np.flatnonzero(TREE.label == PELVIS)[0]] = np.inf
    assert cuts(both=LimbPairs(PAIRS.tip, far)) == []


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


def test_legs_that_do_not_turn_against_the_pelvis_stay_with_it(monkeypatch: pytest.MonkeyPatch) -> None:
    _, tree = extended(0.0, monkeypatch)
    assert tree.shown == ()
    np.testing.assert_array_equal(tree.rest, TREE.rest)
