"""Flesh of the trunk that limbs of a pair hold goes back to it, in every cut and in the tree that cuts agree on."""

import numpy as np
import pytest
from fleshy_legs import ONES, ends, hips, pairs, seen, thigh
from legs import FRAMES, LEAVES
from shipped import TREE

from kinetree.tasks.numerics.structure import agreed_tree, tree_joints, trunk_flesh
from kinetree.tasks.numerics.structure.first_tree import in_tree_order
from kinetree.tasks.numerics.structure.frame_poses import confident_share
from kinetree.tasks.numerics.structure.part_tree import PartPairs, PartTree
from kinetree.tasks.numerics.structure.tree_joints import Cut


def test_its_joint_goes_where_the_limb_turns() -> None:
    body, tree = seen("left")
    left = agreed_tree._without_flesh(body, tree, LEAVES, pairs(), ONES, TREE)
    (before, other), (after, same) = hips(tree), hips(left)
    assert after < 0.5 * before
    assert same == pytest.approx(other, abs=0.2)
    assert ends(left) == ends(tree)
    trust = np.random.default_rng(0).uniform(size=ONES.shape)
    unsure = agreed_tree._without_flesh(body, tree, LEAVES, pairs(), trust, TREE)
    share = confident_share(unsure.label, body.area, trust, FRAMES, len(unsure.parents))
    assert unsure.certain_share == pytest.approx(share)


def test_the_trunk_is_fitted_anew() -> None:
    body, tree = seen("left")
    cut = agreed_tree._without_flesh(body, tree, LEAVES, pairs(), ONES, TREE)
    chest = [int(one.parents[thigh(one, "left")]) for one in (tree, cut)]
    assert np.abs(tree.t[:, chest[0]] - cut.t[:, chest[1]]).max() > 0.0


def test_tree_stays_if_a_joint_would_go(monkeypatch: pytest.MonkeyPatch) -> None:
    body, tree = seen("left")
    real, asked = trunk_flesh.joints_of, list[PartTree]()

    def of_fewer(found: PartTree) -> PartPairs:
        asked.append(found)
        return frozenset(sorted(real(found), key=sorted)[: 2 if len(asked) == 2 else None])

    monkeypatch.setattr(trunk_flesh, "joints_of", of_fewer)
    assert agreed_tree._without_flesh(body, tree, LEAVES, pairs(), ONES, TREE) is tree


def test_nothing_changes_where_there_is_none() -> None:
    body, tree = seen()
    assert agreed_tree._without_flesh(body, tree, LEAVES, pairs(), ONES, TREE) is tree


@pytest.mark.parametrize("is_aligned", [True, False])
def test_agreed_tree_is_without_it_where_vertices_were_aligned(is_aligned: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    body, tree = seen("left")
    monkeypatch.setattr(agreed_tree, "limb_pairs", lambda *_: pairs())
    trust = ONES if is_aligned else None
    left = agreed_tree.agreed_tree(body, [tree], LEAVES, trust, settings=TREE).tree
    assert (hips(left)[0] < 0.5 * hips(tree)[0]) == is_aligned


@pytest.mark.parametrize("is_aligned", [True, False])
def test_every_cut_is_without_it_where_vertices_were_aligned(is_aligned: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    body, tree = seen("left")
    monkeypatch.setattr(tree_joints, "limb_pairs", lambda *_: pairs())
    cut = Cut(body.V, tree.label, tree.R, tree.t, tree.unexplained)
    found = tree_joints.tree_joints(body, cut, LEAVES, ONES if is_aligned else None, settings=TREE)
    left = in_tree_order(found, len(tree.parents))
    assert np.array_equal(left.label, tree.label) == (not is_aligned)
