"""Contract of graph_skeleton: joints of the body, lengths held, in both ways of placing them."""

from typing import Any

import numpy as np
import pytest
from volumetric import volumetric

from kinetree.schemas.paper_2009.graph_skeleton import GraphSkeletonParams
from kinetree.schemas.structure.kinematic_tree import KinematicTree
from kinetree.tasks.numerics.structure import kinematic_tree as numerics
from kinetree.tasks.paper_2009.graph_skeleton import graph_skeleton


def errors(letter: bool) -> np.ndarray:
    """(arm,) mean distance of the nearest joint from each true one."""
    return away(volumetric(letter=letter).tree)


def away(tree: KinematicTree) -> np.ndarray:
    """(arm,) the same of any tree of the body."""
    body = volumetric().body
    true = np.einsum("tpxy,py->tpx", body.R, body.joints) + body.t
    return np.linalg.norm(tree.positions[:, :, None] - true[:, None, 1:], axis=3).mean(axis=0).min(axis=0)


def test_joints_are_where_arms_turn() -> None:
    assert errors(letter=False).max() < 0.3
    assert volumetric().tree.kinds.count("joint") == 3


def test_joints_of_the_letter_are_within_a_node_of_where_arms_turn() -> None:
    assert errors(letter=True).max() < 1.5


@pytest.mark.parametrize("letter", [False, True])
def test_bones_have_one_length_in_all_frames(letter: bool) -> None:
    tree = volumetric(letter=letter).tree
    child = np.flatnonzero(np.array(tree.parents) >= 0)
    length = np.linalg.norm(tree.positions[:, child] - tree.positions[:, np.array(tree.parents)[child]], axis=2)
    assert np.allclose(length, tree.lengths[child])


def test_clusters_that_cost_less_than_asked_for_are_one_part() -> None:
    here = volumetric()
    arguments = (here.integrated_structure, here.graph_motion, here.alignment, here.mesh)
    kinds = [graph_skeleton(*arguments, GraphSkeletonParams(removal_cost=cost)).kinds for cost in (0.0025, 10.0)]
    assert [k.count("joint") for k in kinds] == [3, 0]


def test_joints_follow_the_aligned_surface_and_not_the_nodes() -> None:
    here = volumetric()
    true = {t: a.model_copy(update={"vertices": here.body.x[t]}) for t, a in here.alignment.items()}
    tree = graph_skeleton(here.integrated_structure, here.graph_motion, true, here.mesh, GraphSkeletonParams())
    assert away(tree).max() < 0.5 * errors(letter=False).max()


def test_second_ends_and_the_root_follow_their_parameters(monkeypatch: pytest.MonkeyPatch) -> None:
    here, asked = volumetric(), []

    def listening(*arguments: Any, settings: Any) -> Any:
        asked.append(settings.root_amid_limbs)
        return first(*arguments, settings=settings)

    def noted(*arguments: Any, has_second_ends: bool) -> Any:
        asked.append(has_second_ends)
        return whole(*arguments, has_second_ends=has_second_ends)

    there, whole = graph_skeleton.function.__globals__, numerics.kinematic_tree
    first = there["first_tree"]
    monkeypatch.setitem(there, "first_tree", listening)
    monkeypatch.setattr(numerics, "kinematic_tree", noted)
    for chosen in (GraphSkeletonParams(), GraphSkeletonParams(second_ends=False, root="surface")):
        graph_skeleton(here.integrated_structure, here.graph_motion, here.alignment, here.mesh, chosen)
    assert asked == [True, True, False, False]
