"""The last joint of a limb goes where it turns as flesh does that stays behind, and stays where it turns by itself."""

import numpy as np
import pytest
from articulated import ALL_STAY, chain
from limbs import rotation
from smeared import END, Frames, bent_by_flesh, moving, turning

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.structure import smeared_ends
from kinetree.tasks.numerics.structure.first_tree import FirstTree, in_tree_order
from kinetree.tasks.numerics.structure.inertial_ends import without_inertial_ends
from kinetree.tasks.numerics.structure.limb_pairs import NO_PAIRS
from kinetree.tasks.numerics.structure.pruning import FLESH, Dropped
from kinetree.tasks.numerics.structure.surface_evidence import SurfaceEvidence
from kinetree.tasks.numerics.structure.tree_joints import Cut, tree_joints


@pytest.fixture(autouse=True)
def _all_limbs_have_mirror_images(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(smeared_ends, "of_mirrored_limbs", lambda tree, _: np.ones(len(tree.parents), np.bool_))


def asked(turn: Floats, takes: list[slice] | None = None) -> tuple[FirstTree, FirstTree]:
    """The tree of a tube of three parts that turn so, before and after."""
    body = chain((0.0, END), turn, along=60)
    surface, ones = moving(body)._replace(takes=takes), np.ones(body.x.shape[:2])
    tips = np.array([body.V[:, 2].argmin(), body.V[:, 2].argmax()])
    cut = Cut(body.V, body.label, body.R, body.t, body.residual)
    tree = in_tree_order(tree_joints(surface, cut, tips, ones, settings=ALL_STAY), 3)
    evidence = SurfaceEvidence(Frames(turn).prepared(surface.size), ones, 0.002)
    return tree, without_inertial_ends(surface, tree, NO_PAIRS, evidence)


def test_a_joint_goes_whose_turn_inertia_explains() -> None:
    before, after = asked(bent_by_flesh(4.0))
    assert before.parents.tolist() == [-1, 0, 1]
    assert after.parents.tolist() == [-1, 0]
    assert after.graph.dropped == (*before.graph.dropped, Dropped(2, FLESH))


@pytest.mark.parametrize("turn", [turning(6.0), turning(25.0), bent_by_flesh(20.0)], ids=["own", "far", "dangling"])
def test_a_joint_stays_that_turns_by_itself_or_farther_than_flesh(turn: Floats) -> None:
    before, after = asked(turn)
    assert after is before


def test_a_joint_that_turns_by_itself_in_one_take_stays() -> None:
    turn = np.concatenate([bent_by_flesh(4.0), turning(6.0)])
    before, after = asked(turn, [slice(0, 24), slice(24, 48)])
    assert after is before


def test_where_frames_are_far_apart_nothing_goes() -> None:
    turn = bent_by_flesh(4.0)
    turn[:, 1] = [rotation((1.0, 0.0, 0.0), np.radians(20.0) * (-1.0) ** f) for f in range(len(turn))]
    before, after = asked(turn)
    assert after is before
