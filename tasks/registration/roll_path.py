"""How limbs turned about their own axis over the whole sequence."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.registration.deformation_graph import DeformationGraph
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.registration.rigid_clusters import RigidClusters
from kinetree.schemas.registration.roll_candidates import RollCandidates
from kinetree.schemas.registration.roll_path import RollPath
from kinetree.tasks.numerics.registration.roll_candidates import limbs
from kinetree.tasks.numerics.registration.roll_path import choices
from kinetree.tasks.registration.pose import graph


@task()
def roll_path(
    turns: Mapping[int, RollCandidates], template: DeformationGraph, pieces: RigidClusters, reference: Reference
) -> RollPath:
    """Chooses for every limb the way through its turns that fits clearly better than where it was tracked (ours)."""
    frames = tuple(turns)
    angle, misfit = (np.stack([getattr(t, name) for t in turns.values()]) for name in ("angle", "misfit"))
    turn = choices(angle, misfit, frames.index(reference.frame))
    limb = np.full(len(template.nodes), -1, np.int32)
    if (turn >= 0).any():
        for k, one in enumerate(limbs(graph(template), pieces.label.astype(np.int64))):
            limb[one.node] = k if (turn[:, k] >= 0).any() else -1
    return RollPath(frames=frames, misfit=misfit, turn=turn.astype(np.int32), limb=limb)
