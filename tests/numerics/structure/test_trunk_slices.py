"""A part across the trunk between two joints that lie as near to each other as one does is flesh."""

import numpy as np
import pytest
from articulated import ALL_STAY, swings
from ringed import HEIGHTS, body, cut_of, heights
from smeared import END, moving
from trunk import trunk_with_two_joints, two_pairs

from kinetree.tasks.numerics.structure import agreed_tree as agreed
from kinetree.tasks.numerics.structure.agreed_tree import agreed_tree
from kinetree.tasks.numerics.structure.first_tree import FirstTree
from kinetree.tasks.numerics.structure.limb_pairs import NO_PAIRS
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.pruning import FLESH
from kinetree.tasks.numerics.structure.trunk_slices import trunk_slices

THIN, THICK = (0.0, 0.5), (0.0, 0.9)
"""Heights between which a ring of flesh lies about the middle joint of a tube whose radius is 1."""


def leaves(above: int, below: int) -> np.ndarray:
    """(leaf,) so many vertices of the highest and of the lowest part."""
    z = body().V[:, 2]
    return np.concatenate([np.argsort(-z)[:above], np.argsort(z)[:below]])


@pytest.mark.parametrize(
    ("at", "above", "below", "count"), [(THIN, 2, 2, 1), (THICK, 2, 2, 0), (THIN, 1, 1, 0)], ids=["thin", "thick", "in a limb"]
)
def test_a_thin_part_that_carries_several_limbs_is_a_slice(at: tuple[float, float], above: int, below: int, count: int) -> None:
    tree = cut_of(body(), (at, 0.15))
    found = trunk_slices(moving(body()), tree, leaves(above, below), NO_PAIRS)
    assert len(found) == count
    for one in found:
        assert tree.parents[[one.part, *one.below]].tolist() == [one.above, one.part]
        z = body().V[tree.label == one.part, 2]
        assert at[0] <= z.min() < z.max() <= at[1]


def test_of_slices_beside_each_other_one_is_given() -> None:
    tree = cut_of(body(), (THICK, 0.15))
    close = tree._replace(rest=0.1 * tree.rest)
    assert len(trunk_slices(moving(body()), tree, leaves(2, 2), NO_PAIRS)) == 0
    found = trunk_slices(moving(body()), close, leaves(2, 2), NO_PAIRS)
    assert len(found) > 0
    taken = [part for one in found for part in (one.part, *one.below)]
    assert len(set(taken)) == len(taken)


def test_a_slice_is_shared_out_between_its_neighbours_though_other_cuts_have_it() -> None:
    tree, ones = cut_of(body(), (THIN, 0.02)), np.ones((len(body().R), len(body().V)))
    found = agreed_tree(moving(body()), [tree] * 3, leaves(2, 2), ones, settings=ALL_STAY).tree
    assert len(tree.parents) == len(HEIGHTS) + 2
    np.testing.assert_allclose(heights(found), HEIGHTS, atol=0.3)
    assert [d.reason for d in found.graph.dropped] == [FLESH]


def about_limbs(below: float) -> tuple[MovingSurface, FirstTree]:
    """A trunk whose highest part, on which two limbs hang, begins so far below them; its border has a radius of 1."""
    turn = swings(24, 4, 20.0, axes=1, seed=1)
    trunk, tree = trunk_with_two_joints(turn, (-1.2, END - below), (-1.2, END - below))
    return trunk, tree._replace(parents=np.where(np.arange(8) == 7, 5, tree.parents))


@pytest.mark.parametrize(("below", "count"), [(0.5, 1), (0.7, 0)])
def test_a_part_whose_joint_lies_amid_two_limbs_that_it_carries_is_a_slice(below: float, count: int) -> None:
    trunk, tree = about_limbs(below)
    pairs = two_pairs(trunk)
    found = trunk_slices(trunk, tree, pairs.tip.ravel(), pairs)
    assert [(one.part, one.above, one.below) for one in found] == [(2, 1, (5, 6))] * count
    assert trunk_slices(trunk, tree, pairs.tip.ravel(), NO_PAIRS) == [], "its limbs are no mirror images"
    with_head = tree._replace(parents=np.where(np.arange(8) == 7, 2, tree.parents))
    assert trunk_slices(trunk, with_head, pairs.tip.ravel(), pairs) == [], "a head hangs on it"


def test_its_flesh_goes_to_the_trunk_on_which_the_limbs_hang_then(monkeypatch: pytest.MonkeyPatch) -> None:
    trunk, tree = about_limbs(0.4)
    pairs, ones = two_pairs(trunk), np.ones(trunk.x.shape[:2])
    monkeypatch.setattr(agreed, "limb_pairs", lambda *of: pairs)
    monkeypatch.setattr(agreed, "mirrored_slices", lambda *of: [])
    found = agreed_tree(trunk, [tree] * 3, pairs.tip.ravel(), ones, settings=ALL_STAY).tree
    assert (2, FLESH) in found.graph.dropped
    (own,) = np.unique(found.label[np.isin(tree.label, [1, 2])]).tolist()
    assert own in found.parents[found.label[np.isin(tree.label, [5, 6])]], "a limb hangs on the part in their place"
