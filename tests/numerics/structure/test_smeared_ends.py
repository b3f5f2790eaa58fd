"""The last joint of a limb that an alignment smears goes where the frames' surfaces show another without it."""

from functools import cache
from typing import NamedTuple

import numpy as np
import pytest
from articulated import ALL_STAY, chain
from smeared import END, Frames, turning
from smeared import moving as surface_of

from kinetree.tasks.numerics.geometry.rigid_fit import rigid_motion
from kinetree.tasks.numerics.structure import shown_joints, smeared_ends
from kinetree.tasks.numerics.structure.end_joints import judged_runs
from kinetree.tasks.numerics.structure.first_tree import FirstTree, in_tree_order
from kinetree.tasks.numerics.structure.limb_pairs import NO_PAIRS
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.pruning import SMEARED, Dropped
from kinetree.tasks.numerics.structure.shown_joints import with_end_joints
from kinetree.tasks.numerics.structure.smeared_ends import without_smeared_ends
from kinetree.tasks.numerics.structure.surface_evidence import KnownFits, SurfaceEvidence, all_end_rings
from kinetree.tasks.numerics.structure.tree_joints import Cut, tree_joints
from kinetree.tasks.numerics.structure.without_joint import without_joint

BEFORE = 1.3
"""Height at which a cut has the joint that lies at END."""


class Smeared(NamedTuple):
    """As aligned, its tree, and what the frames show."""

    body: MovingSurface
    tree: FirstTree
    evidence: SurfaceEvidence


@pytest.fixture(autouse=True)
def _all_limbs_have_mirror_images(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(smeared_ends, "of_mirrored_limbs", lambda tree, _: np.ones(len(tree.parents), np.bool_))


def smeared(height: float = BEFORE, degrees: float = 25.0, times: int = 1) -> Smeared:
    """A tube whose cut has its second joint at a height before the true one, with motions of vertices that are spread there.

    times : how often it moves as it does in 24 frames
    """
    turn = np.concatenate([turning(degrees)] * times)
    body, half = chain((0.0, END), turn, along=60), chain((0.0, height), turn, blend=1.5, along=60)
    label = np.searchsorted(np.array([0.0, height]), body.V[:, 2])
    V = np.broadcast_to(body.V, half.x.shape)
    fits = [rigid_motion(V[:, label == p], half.x[:, label == p]) for p in range(3)]
    R, t = (np.stack(of, axis=1) for of in zip(*fits, strict=True))
    tips = np.array([body.V[:, 2].argmin(), body.V[:, 2].argmax()])
    moving, ones = surface_of(body)._replace(x=half.x), np.ones(half.x.shape[:2])
    joints = tree_joints(moving, Cut(body.V, label, R, t, np.zeros(R.shape[:2])), tips, ones, settings=ALL_STAY)
    frames = cache(Frames(turn, 0.01).prepared(moving.size))
    return Smeared(moving, in_tree_order(joints, 3), SurfaceEvidence(frames, ones, 0.002))


def asked(of: Smeared, known: KnownFits | None = None) -> FirstTree:
    return without_smeared_ends(of.body, of.tree, KnownFits({}) if known is None else known, NO_PAIRS, of.evidence)


def with_joints(of: Smeared) -> FirstTree:
    rings = all_end_rings(of.body.V, of.body.F, of.body.area, of.tree, NO_PAIRS)
    fits = KnownFits({}).laid(of.evidence.frames(of.body, of.tree), judged_runs(len(of.body.x), None), rings)
    tips = np.array([of.body.V[:, 2].argmin(), of.body.V[:, 2].argmax()])
    return with_end_joints(of.body, of.tree, tips, fits, of.evidence.surface, of.evidence.confidence, 0.002)


def test_the_joint_goes_and_the_one_that_the_frames_show_takes_its_place() -> None:
    of = smeared()
    assert of.tree.parents.tolist() == [-1, 0, 1]
    assert of.tree.rest[2, 2] < 2.0
    after = with_joints(of)
    assert after.graph.dropped == (*of.tree.graph.dropped, Dropped(2, SMEARED))
    assert after.parents.tolist() == [-1, 0, 1]
    assert after.shown == (2,)
    assert abs(after.rest[2, 2] - END) < 0.4


def test_what_was_asked_is_known() -> None:
    of, known = smeared(), KnownFits({})
    after = asked(of, known)
    assert after.parents.tolist() == [-1, 0]
    rings = all_end_rings(of.body.V, of.body.F, of.body.area, after, NO_PAIRS)
    assert rings
    before = dict(known.fits)
    known.laid(of.evidence.frames(of.body, after), judged_runs(len(of.body.x), None), rings)
    assert known.fits == before


def test_it_stays_where_the_frames_show_no_other() -> None:
    of = smeared(degrees=0.0)
    assert asked(of) is of.tree


def test_it_stays_far_from_the_joint_before() -> None:
    of = smeared()
    far = of.tree.rest.copy()
    far[2, 2] = far[1, 2] + 1.01 * smeared_ends.CLOSE * of.tree.radius[2]
    assert asked(of._replace(tree=of.tree._replace(rest=far))).parents.tolist() == [-1, 0, 1]


@pytest.mark.parametrize(("height", "stays"), [(1.4, True), (1.1, False)])
def test_on_a_limb_without_a_mirror_image_it_must_lie_closer(
    height: float, stays: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    of = smeared(height)
    monkeypatch.setattr(smeared_ends, "of_mirrored_limbs", lambda tree, _: np.zeros(len(tree.parents), np.bool_))
    assert (asked(of) is of.tree) == stays


def test_what_is_known_stays_that_of_the_frames_that_are_judged() -> None:
    """Of 72 frames 52; a joint that shows is laid in all of them."""
    of, known = smeared(times=3), KnownFits({})
    assert len(asked(of, known).parents) == 2
    judged = np.concatenate(judged_runs(72, None))
    assert len(judged) < 72
    assert known.fits
    assert all(set(fits) <= set(judged.tolist()) for fits in known.fits.values())


@pytest.mark.parametrize(
    ("parents", "close"), [([-1, 0], []), ([-1, 0, 0], []), ([-1, 0, 1], [2]), ([-1, 0, 1, 1], []), ([-1, 0, 1, 2], [3])]
)
def test_which_joints_are_asked_for(parents: list[int], close: list[int]) -> None:
    """The last of a limb, on a part that carries nothing else and is not the root."""
    tree, count = smeared().tree, len(parents)
    heights, radius = np.arange(count)[:, None] * [0.0, 0.0, 1.0], np.ones(count)
    assert smeared_ends.close_ends(tree._replace(parents=np.array(parents), rest=heights, radius=radius), NO_PAIRS) == close


def test_both_limbs_may_lose_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """Parts are numbered anew once one is gone."""
    of, count = smeared(), 5
    label = np.digitize(of.body.V[:, 2], [-2.5, -1.0, 1.0, 2.5])[:, None] == [2, 3, 4, 1, 0]
    rest = np.array([0.0, 1.0, 2.5, -1.0, -2.5])[:, None] * [0.0, 0.0, 1.0]
    frames = len(of.body.x)
    tree = of.tree._replace(
        parents=np.array([-1, 0, 1, 0, 3]),
        place=np.arange(count),
        label=label.argmax(axis=1),
        rest=rest,
        radius=np.ones(count),
        R=np.broadcast_to(np.eye(3), (frames, count, 3, 3)),
        t=np.zeros((frames, count, 3)),
        certain_share=np.ones((frames, count)),
        drift=np.zeros(count),
        unexplained=np.zeros((frames, count)),
    )
    parts = list[int]()
    monkeypatch.setattr(smeared_ends, "end_joints", lambda _, rings, *of: parts.extend({r.cut.part for r in rings}) or [1])
    after = without_smeared_ends(of.body, tree, KnownFits({}), NO_PAIRS, of.evidence)
    assert parts == [1, 2]
    assert after.parents.tolist() == [-1, 0, 0]
    assert after.place.tolist() == [0, 1, -1, 2, -1]
    np.testing.assert_array_equal(after.label, np.array([0, 1, 1, 2, 2])[tree.label])


def test_the_joint_stays_if_the_surfaces_show_one_less_in_the_end(monkeypatch: pytest.MonkeyPatch) -> None:
    of = smeared()
    gone = without_joint(of.body, of.tree, 2, of.evidence, SMEARED)
    monkeypatch.setattr(shown_joints, "without_smeared_ends", lambda *of: gone)
    assert with_joints(of).parents.tolist() == [-1, 0, 1]
    monkeypatch.setattr(shown_joints, "end_joints", lambda *of, **more: [])
    after = with_joints(of)
    assert after.parents.tolist() == [-1, 0, 1]
    np.testing.assert_array_equal(after.rest, of.tree.rest)
    assert after.graph.dropped == of.tree.graph.dropped


def test_a_joint_that_shows_elsewhere_is_none_in_its_place() -> None:
    of = smeared()
    left, after = asked(of), with_joints(of)
    elsewhere = after._replace(label=np.where(of.body.V[:, 2] < -2.0, 2, left.label))
    assert len(elsewhere.parents) == len(of.tree.parents)
    assert smeared_ends.are_replaced(of.tree, left, after)
    assert not smeared_ends.are_replaced(of.tree, left, elsewhere)
    assert smeared_ends.are_replaced(of.tree, of.tree, of.tree)
