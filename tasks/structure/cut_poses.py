"""The poses in which the body is cut once more."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.structure.cut_poses import CutPoses
from kinetree.schemas.structure.rigid_parts import CutParams, RigidPartsParams
from kinetree.tasks.numerics.structure.further_cut import distinct_poses
from kinetree.tasks.numerics.structure.given_correspondence import limited_confidence


@task(among=Sequence, block="rigid_parts")
def cut_poses(reference: Reference, alignment: Mapping[int, Alignment], params: RigidPartsParams) -> CutPoses:
    """Chooses frames whose poses differ most, so that further cuts need not wait for the first (ours)."""
    frames, aligned = tuple(alignment), list(alignment.values())
    x = np.stack([a.vertices for a in aligned])
    confidence = limited_confidence(np.stack([a.confidence for a in aligned]))
    chosen = distinct_poses(x, confidence, frames.index(reference.frame), params.cuts - 1)
    return CutPoses(frames=tuple(frames[t] for t in chosen), settings=CutParams(**params.model_dump(exclude={"cuts"})))
