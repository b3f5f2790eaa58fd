"""The last joint of a limb that an alignment smears goes where the frames' surfaces show another without it."""

from functools import cache
from typing import NamedTuple

import numpy as np
import pytest
from articulated import ALL_STAY, chain
from smeared import END, Frames, turning
from smeared import moving as surface_of

from kinetree.tasks.numerics.geometry.rigid_fit import rigid_motion
from kinetree.tasks.numerics.structure import smeared_ends
from kinetree.tasks.numerics.structure.end_joints import judged_runs
from kinetree.tasks.numerics.structure.first_tree import FirstTree, in_tree_order
from kinetree.tasks.numerics.structure.limb_pairs import NO_PAIRS
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.pruning import SMEARED, Dropped
from kinetree.tasks.numerics.structure.shown_joints import with_end_joints
from kinetree.tasks.numerics.structure.smeared_ends import without_smeared_ends
from kinetree.tasks.numerics.structure.surface_evidence import KnownFits, SurfaceEvidence, all_end_rings
from kinetree.tasks.numerics.structure.tree_joints import Cut, tree_joints

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


def smeared(height: float = BEFORE, degrees: float = 25.0) -> Smeared:
    """A tube whose cut has its second joint at a height before the true one, with motions of vertices that are spread there."""
    turn = turning(degrees)
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
    rings = all_end_rings(of.body, of.tree, NO_PAIRS)
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
    rings = all_end_rings(of.body, after, NO_PAIRS)
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


def test_it_stays_on_a_limb_without_a_mirror_image(monkeypatch: pytest.MonkeyPatch) -> None:
    of = smeared()
    monkeypatch.setattr(smeared_ends, "of_mirrored_limbs", lambda tree, _: np.zeros(len(tree.parents), np.bool_))
    assert asked(of) is of.tree


def test_a_joint_on_the_root_or_beside_another_stays() -> None:
    of = smeared()
    for parents in ([-1, 0, 0], [-1, 0, 1, 1]):
        tree = of.tree._replace(parents=np.array(parents))
        if len(parents) > 3:
            tree = tree._replace(rest=tree.rest[[0, 1, 2, 2]], radius=tree.radius[[0, 1, 2, 2]])
        assert smeared_ends._close_ends(tree, NO_PAIRS) == []
    assert smeared_ends._close_ends(of.tree, NO_PAIRS) == [2]
