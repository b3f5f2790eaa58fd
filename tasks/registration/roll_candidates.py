"""Limbs tried in other turns about their own axis, in one frame."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.registration.deformation_graph import DeformationGraph
from kinetree.schemas.registration.refit import FirstRefit
from kinetree.schemas.registration.rigid_clusters import RigidClusters
from kinetree.schemas.registration.roll_candidates import RollCandidates
from kinetree.tasks.numerics.registration import roll_candidates as numerics
from kinetree.tasks.registration.pose import graph, pose, target


@task(over="frame")
def roll_candidates(mesh: Mesh, template: DeformationGraph, refit: FirstRefit, pieces: RigidClusters) -> RollCandidates:
    """Fits every limb as a rigid body from several turns about its axis (ours)."""
    if not len(template.nodes):
        none = (0, numerics.TURNS)
        return RollCandidates(
            angle=np.empty(none), misfit=np.empty(none), rotation=np.empty((*none, 3, 3)), place=np.empty((*none, 3))
        )
    found = numerics.roll_candidates(graph(template), pose(refit), target(mesh, template), pieces.label.astype(np.int64))
    return RollCandidates(**found._asdict())
