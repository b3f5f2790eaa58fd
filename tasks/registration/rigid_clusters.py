"""Which nodes of the deformation graph have moved as one."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.registration.deformation_graph import DeformationGraph
from kinetree.schemas.registration.refit import FirstRefit
from kinetree.schemas.registration.rigid_clusters import RigidClusters
from kinetree.tasks.numerics.registration.rigid_clusters import rigid_clusters as numerics
from kinetree.tasks.registration.pose import graph, pose


@task()
def rigid_clusters(template: DeformationGraph, refit: tuple[FirstRefit, ...]) -> RigidClusters:
    """Merges nodes that one rigid motion carries in every frame (ours)."""
    if not len(template.nodes):
        return RigidClusters(label=np.empty(0, np.int32))
    return RigidClusters(label=numerics(graph(template), [pose(p) for p in refit]).astype(np.int32))
