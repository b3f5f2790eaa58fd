"""A joint within a limb goes where it turns as flesh does that stays behind, and stays where it turns by itself."""

import numpy as np
import pytest
from articulated import ALL_STAY, chain
from limbs import rotation
from scipy.spatial.transform import Rotation
from smeared import END, Frames, bent_by_flesh, moving, turning

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.structure import inertial_joints
from kinetree.tasks.numerics.structure.first_tree import FirstTree, in_tree_order
from kinetree.tasks.numerics.structure.inertial_joints import without_inertial_joints
from kinetree.tasks.numerics.structure.limb_pairs import NO_PAIRS
from kinetree.tasks.numerics.structure.pruning import FLESH, Dropped
from kinetree.tasks.numerics.structure.surface_evidence import SurfaceEvidence
from kinetree.tasks.numerics.structure.tree_joints import Cut, tree_joints


@pytest.fixture(autouse=True)
def _all_limbs_have_mirror_images(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(inertial_joints, "of_mirrored_limbs", lambda tree, _: np.ones(len(tree.parents), np.bool_))


def asked(
    turn: Floats, takes: list[slice] | None = None, heights: tuple[float, ...] = (0.0, END)
) -> tuple[FirstTree, FirstTree]:
    """The tree of a tube whose parts turn so about joints at these heights, before and after."""
    body = chain(heights, turn, along=60)
    surface, ones = moving(body)._replace(takes=takes), np.ones(body.x.shape[:2])
    tips = np.array([body.V[:, 2].argmin(), body.V[:, 2].argmax()])
    cut = Cut(body.V, body.label, body.R, body.t, body.residual)
    tree = in_tree_order(tree_joints(surface, cut, tips, ones, settings=ALL_STAY), len(heights) + 1)
    evidence = SurfaceEvidence(Frames(turn, heights=heights).prepared(surface.size), ones, 0.002)
    return tree, without_inertial_joints(surface, tree, NO_PAIRS, evidence)


def test_a_joint_goes_whose_turn_inertia_explains() -> None:
    before, after = asked(bent_by_flesh(4.0))
    assert before.parents.tolist() == [-1, 0, 1]
    assert after.parents.tolist() == [-1, 0]
    assert after.graph.dropped == (*before.graph.dropped, Dropped(2, FLESH))


def test_one_amid_a_bone_goes_and_both_halves_move_as_one() -> None:
    turn = np.concatenate([bent_by_flesh(3.0), turning(25.0)[:, 2:]], axis=1)
    before, after = asked(turn, heights=(0.0, 1.6, 3.2))
    assert before.parents.tolist() == [-1, 0, 1, 2]
    assert after.parents.tolist() == [-1, 0, 1]
    assert after.graph.dropped == (*before.graph.dropped, Dropped(2, FLESH))
    np.testing.assert_allclose(after.rest[:, 2], [after.rest[0, 2], 0.0, 3.2], atol=0.1)
    first, second, both = before.R[:, 1], before.R[:, 2], after.R[:, 1]
    bend, half = (Rotation.from_matrix(first.swapaxes(1, 2) @ R) for R in (second, both))
    share = half.magnitude().sum() / bend.magnitude().sum()
    assert 0.3 < share < 0.7
    assert after.drift[2] < 0.05


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
