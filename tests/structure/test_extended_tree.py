"""The tree with joints at ends as the task gives it."""

import numpy as np
import pytest
from aligned_body import extended, tube

from kinetree.schemas.structure.extended_tree import ExtendedTree
from kinetree.schemas.structure.kinematic_tree import FirstTreeParams
from kinetree.tasks.methods import METHODS
from kinetree.tasks.structure.arguments.joint_tree import restored
from kinetree.tasks.structure.first_tree import first_tree


def tree_of_tube(trust: float, surface_joints: bool = True, **params: float) -> ExtendedTree:
    reference, parts, alignment, mesh, leaves = tube(trust)
    first = first_tree(reference, parts, alignment, mesh, leaves, FirstTreeParams(**params))
    return extended(first, reference, alignment, mesh, leaves, surface_joints)


def test_a_joint_that_the_frames_alone_show_comes_last() -> None:
    tree = tree_of_tube(0.99)
    assert (tree.ends, tree.parents) == (1, (-1, 0, 1))
    assert tree.end_positions.shape == (24, int(restored(tree).at_ends.sum()), 3)


@pytest.mark.parametrize(("trust", "params"), [(1.0, {}), (0.99, {"end_joints": False})])
def test_where_all_is_given_or_it_is_not_asked_the_tree_is_the_first(trust: float, params: dict[str, float]) -> None:
    tree, (reference, parts, alignment, mesh, leaves) = tree_of_tube(trust, **params), tube(trust)
    first = first_tree(reference, parts, alignment, mesh, leaves, FirstTreeParams(**params))
    assert tree.ends == 0
    for name in first.array_fields():
        np.testing.assert_array_equal(getattr(tree, name), getattr(first, name), err_msg=name)


def test_frames_that_parts_are_laid_on_are_a_few_at_a_time_and_none_where_all_is_given_or_it_is_not_asked() -> None:
    tree = tree_of_tube(0.99)
    runs = [tree.members("laid/frame", (k,)) for k in tree.members("laid", ())]
    assert [len(run) for run in runs] == [2] * 12
    assert [frame for run in runs for frame in run] == list(tree.frames)
    assert list(tree_of_tube(1.0).members("laid", ())) == []
    assert list(tree_of_tube(0.99, surface_joints=False).members("laid", ())) == []


def test_it_is_made_beside_further_cuts() -> None:
    assert "further_cut" not in METHODS["mesoscopic"].until(["extended_tree"]).by_name
