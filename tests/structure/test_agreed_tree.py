"""The tree that the cuts agree on as the task gives it."""

import sys
from typing import Any

import numpy as np
import pytest
from aligned_body import FIRST, agreed, tube

from kinetree.schemas.structure.agreed_tree import AgreedTree
from kinetree.schemas.structure.cut_poses import CutPoses
from kinetree.schemas.structure.kinematic_tree import AgreedTreeParams, CutJointsParams, FirstTreeParams
from kinetree.tasks.structure.arguments.joint_tree import restored
from kinetree.tasks.structure.first_tree import first_tree
from kinetree.tasks.structure.further_cut import further_cut

CUTS = (FIRST + 5, FIRST + 9)


def tree_of_tube(trust: float, cuts: tuple[int, ...] = (), **params: Any) -> AgreedTree:
    reference, parts, alignment, mesh, leaves = tube(trust)
    first = first_tree(reference, parts, alignment, mesh, leaves, FirstTreeParams())
    poses = CutPoses(frames=cuts)
    further = {f: further_cut(poses, reference, alignment, leaves, CutJointsParams(), (f,)) for f in cuts}
    return agreed(first, reference, alignment, mesh, leaves, further, AgreedTreeParams(**params))


def test_frames_in_which_rings_are_judged_are_a_few_at_a_time_and_none_where_all_is_given_or_it_is_not_asked() -> None:
    tree = tree_of_tube(0.99)
    runs = [tree.members("judged/frame", (k,)) for k in tree.members("judged", ())]
    assert [len(run) for run in runs] == [5, 5, 5, 5, 4]
    assert [frame for run in runs for frame in run] == list(tree.frames)
    assert tree_of_tube(1.0).judged == tree_of_tube(0.99, end_joints=False).judged == ()
    assert (tree.is_given, tree_of_tube(1.0).is_given) == (False, True)


def test_without_further_cuts_it_is_the_first_tree() -> None:
    reference, parts, alignment, mesh, leaves = tube(0.99)
    first, tree = first_tree(reference, parts, alignment, mesh, leaves, FirstTreeParams()), tree_of_tube(0.99)
    assert tree.cut_frame is None
    for name in first.array_fields():
        np.testing.assert_array_equal(getattr(tree, name), getattr(first, name), err_msg=name)


@pytest.mark.parametrize(("trust", "law"), [(1.0, "agreeing_cut"), (0.99, "agreed_tree")])
def test_it_says_in_which_frame_the_cut_is_whose_tree_it_has(trust: float, law: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """By one law where all is given, by another where vertices were aligned."""
    task, seen = sys.modules["kinetree.tasks.structure.agreed_tree"], []

    def second(*of: Any, **settings: Any) -> Any:
        trees = of[0] if trust == 1.0 else of[1]
        seen.append(trees)
        return 2 if trust == 1.0 else (2, trees[2])

    monkeypatch.setattr(task if trust == 1.0 else task.numerics, law, second)
    tree = tree_of_tube(trust, CUTS)
    assert tree.cut_frame == CUTS[1]
    np.testing.assert_array_equal(restored(tree).rest, seen[0][2].rest)
    assert [len(trees) for trees in seen] == [3]


def test_what_counts_as_a_joint_and_the_frames_reach_the_numerics(monkeypatch: pytest.MonkeyPatch) -> None:
    task, asked = sys.modules["kinetree.tasks.structure.agreed_tree"], []

    def listening(*of: Any, settings: Any) -> Any:
        asked.append((of[4].settings.clear_motion, settings.pruning.degrees, settings.pruning.ratio))
        return 0, of[1][0]

    monkeypatch.setattr(task.numerics, "agreed_tree", listening)
    tree_of_tube(0.99, CUTS, clear_motion=7.0, degrees=4.0, ratio=0.5)
    assert asked == [(7.0, 4.0, 0.5)]
