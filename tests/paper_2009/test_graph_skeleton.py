"""Contract of graph_skeleton: joints of the body, lengths held, in both ways of placing them."""

import numpy as np
import pytest
from volumetric import volumetric

from kinetree.schemas.paper_2009.graph_skeleton import GraphSkeletonParams
from kinetree.schemas.paper_2009.node_clusters import NodeClustersParams
from kinetree.tasks.paper_2009.graph_skeleton import graph_skeleton
from kinetree.tasks.paper_2009.integrated_structure import integrated_structure
from kinetree.tasks.paper_2009.node_clusters import node_clusters


def errors(letter: bool) -> np.ndarray:
    """(arm,) mean distance of the nearest joint from each true one."""
    here = volumetric(letter=letter)
    true = np.einsum("tpxy,py->tpx", here.body.R, here.body.joints) + here.body.t
    return np.linalg.norm(here.tree.positions[:, :, None] - true[:, None, 1:], axis=3).mean(axis=0).min(axis=0)


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


def test_removal_cost_of_the_clusters_holds_for_their_motions_too() -> None:
    here = volumetric()
    dear = NodeClustersParams(removal_cost=10.0)
    clusters = {0: node_clusters((0,), here.initial_model[0], here.graph_deformation, dear)}
    one = integrated_structure(here.initial_frames, here.initial_model, clusters, here.similarity)
    assert one.removal_cost == 10.0
    costs: tuple[dict[str, float], ...] = ({}, {"removal_cost": 10.0})
    same, other = (
        graph_skeleton(here.integrated_structure.model_copy(update=cost), here.graph_motion, here.mesh, GraphSkeletonParams())
        for cost in costs
    )
    assert same == here.tree != other
