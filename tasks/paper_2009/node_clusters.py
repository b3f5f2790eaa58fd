"""The nodes of one structure that move as one rigid body."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.array import Index
from kinetree.schemas.paper_2009.graph_deformation import GraphDeformation
from kinetree.schemas.paper_2009.initial_model import InitialModel
from kinetree.schemas.paper_2009.node_clusters import NodeClusters, NodeClustersParams
from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.surface import surface_areas
from kinetree.tasks.numerics.paper_2009 import node_clusters as numerics


@task(over="structure")
def node_clusters(
    index: Index, initial_model: InitialModel, deformations: Mapping[int, GraphDeformation], params: NodeClustersParams
) -> NodeClusters:
    """Clusters neighbouring nodes by their motion (2009, Sec. 2.3.1, Eqs. 5, 6; Fig. 2)."""
    model, moved = initial_model, list(deformations.values())
    parents, label = np.array(model.parents), np.array(model.label)
    X = np.stack([d.position for d in moved])
    children = np.arange(1, len(parents))
    pair = np.stack([parents[children], children], axis=1)
    r = numerics.velocity_correlation(X, pair, relative=params.relative, one_too_few=params.one_too_few)
    if params.rule == "correlation":
        cluster = numerics.correlated_clusters(parents, r, params.threshold)
        part = cluster[label]
    else:
        part = _rigid(model, moved, params.removal_cost)
        cluster = _of_nodes(part, label, len(parents))
    return NodeClusters(
        structure=index[0],
        cluster=cluster,
        part=part,
        correlation=np.concatenate([[1.0], r]),
    )


def _rigid(model: InitialModel, moved: list[GraphDeformation], removal_cost: float) -> Ints:
    """(vertex,) clusters by what each is needed for."""
    V, F = np.array(model.vertices), np.array(model.faces)
    x, confidence = np.stack([d.vertices for d in moved]), np.stack([d.confidence for d in moved])
    area: Floats = surface_areas(V, F)
    return numerics.rigid_clusters(V, F, x, confidence, area, np.array(model.label), removal_cost)


def _of_nodes(part: Ints, label: Ints, count: int) -> Ints:
    """(node,) the cluster of most of a node's vertices; 0 for a node without any."""
    votes = np.zeros((count, int(part.max(initial=0)) + 1), np.int64)
    np.add.at(votes, (label, part), 1)
    return np.asarray(votes.argmax(axis=1), dtype=np.int64)
