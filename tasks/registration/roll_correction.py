"""The first refit with every limb in the turn that it has over the whole sequence."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.registration.deformation_graph import DeformationGraph
from kinetree.schemas.registration.refit import FirstRefit
from kinetree.schemas.registration.rigid_clusters import RigidClusters
from kinetree.schemas.registration.roll_candidates import RollCandidates
from kinetree.schemas.registration.roll_correction import RollCorrection
from kinetree.schemas.registration.roll_path import RollPath
from kinetree.tasks.numerics.registration import roll_candidates as numerics
from kinetree.tasks.registration.pose import graph, pose


@task(over="frame")
def roll_correction(
    template: DeformationGraph, refit: FirstRefit, pieces: RigidClusters, turns: RollCandidates, twist: RollPath
) -> RollCorrection:
    """Puts limbs that had lost their twist where the whole sequence says they are (ours)."""
    found = pose(refit)
    chosen = twist.turn[(twist.misfit == turns.misfit).all(axis=(1, 2)).argmax()]
    if (chosen >= 0).any():
        tried = numerics.RollCandidates(turns.angle, turns.misfit, turns.rotation, turns.place)
        found = numerics.untwisted(graph(template), found, pieces.label.astype(np.int64), tried, chosen)
    return RollCorrection(steps=refit.steps, rotation=found.rotation, translation=found.translation)
