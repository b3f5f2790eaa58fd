"""The tree with joints at ends as the task gives it."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from aligned_body import agreed, extended, tube

from kinetree.schemas.structure.extended_tree import ExtendedTree
from kinetree.schemas.structure.kinematic_tree import AgreedTreeParams, FirstTreeParams
from kinetree.tasks.numerics.structure import shown_joints as numerics
from kinetree.tasks.numerics.structure.end_joints import EndJoint
from kinetree.tasks.numerics.structure.end_rings import EndFrames, EndRing
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs
from kinetree.tasks.structure.arguments.joint_tree import restored
from kinetree.tasks.structure.first_tree import first_tree


def tree_of_tube(trust: float, surface_joints: bool = True, end_joints: bool = True) -> ExtendedTree:
    reference, parts, alignment, mesh, leaves = tube(trust)
    first = first_tree(reference, parts, alignment, mesh, leaves, FirstTreeParams())
    tree = agreed(first, reference, alignment, mesh, leaves, params=AgreedTreeParams(end_joints=end_joints))
    return extended(tree, reference, alignment, mesh, leaves, surface_joints)


def test_a_joint_that_the_frames_alone_show_comes_last() -> None:
    tree = tree_of_tube(0.99)
    assert (tree.shown, tree.parents) == ((2,), (-1, 0, 1))
    assert tree.end_positions.shape == (24, int(restored(tree).at_ends.sum()), 3)


@pytest.mark.parametrize(("tips", "mirrored"), [((0, -1), [1]), ((-1, -1), []), ((), [])])
def test_parts_that_end_limbs_with_a_mirror_image_are_told(
    tips: tuple[int, ...], mirrored: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The lower part carries the upper one, so that it is of no limb; a part with both ends of a pair has no mirror image."""
    told: list[list[int]] = []
    whole, V = numerics.end_joints, tube(0.99)[0].vertices

    def telling(frames: EndFrames, rings: Sequence[EndRing], *of: Any) -> list[EndJoint]:
        told.append(sorted({ring.cut.part for ring in rings if ring.is_mirrored}))
        return whole(frames, rings, *of)

    tip = np.argsort(V[:, 2])[list(tips)].reshape(-1, 2)
    monkeypatch.setattr(numerics, "limb_pairs", lambda *of: LimbPairs(tip, np.zeros((len(tip), 2, len(V)))))
    monkeypatch.setattr(numerics, "end_joints", telling)
    tree_of_tube(0.99)
    assert told[0] == mirrored


@pytest.mark.parametrize(("trust", "end_joints"), [(1.0, True), (0.99, False)])
def test_where_all_is_given_or_it_is_not_asked_the_tree_is_the_first(trust: float, end_joints: bool) -> None:
    tree, (reference, parts, alignment, mesh, leaves) = tree_of_tube(trust, end_joints=end_joints), tube(trust)
    first = first_tree(reference, parts, alignment, mesh, leaves, FirstTreeParams())
    assert tree.shown == ()
    for name in first.array_fields():
        np.testing.assert_array_equal(getattr(tree, name), getattr(first, name), err_msg=name)


def test_frames_that_parts_are_laid_on_are_a_few_at_a_time_and_none_where_all_is_given_or_it_is_not_asked() -> None:
    tree = tree_of_tube(0.99)
    runs = [tree.members("laid/frame", (k,)) for k in tree.members("laid", ())]
    assert [len(run) for run in runs] == [2] * 12
    assert [frame for run in runs for frame in run] == list(tree.frames)
    assert list(tree_of_tube(1.0).members("laid", ())) == []
    assert list(tree_of_tube(0.99, surface_joints=False).members("laid", ())) == []
