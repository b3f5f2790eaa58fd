"""Which frames of an alignment are to be believed."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.frame_confidence import FrameConfidence
from kinetree.schemas.registration.reference import Reference
from kinetree.tasks.numerics.registration.frame_confidence import trusted


@task()
def frame_confidence(alignment: Mapping[int, Alignment], reference: Reference) -> FrameConfidence:
    """Compares what the frames say of themselves and marks those that stand out (ours)."""
    residual = np.array([a.distance for a in alignment.values()]) / reference.size
    uncovered = np.array([a.uncovered for a in alignment.values()])
    return FrameConfidence(
        frames=tuple(alignment),
        residual=residual,
        uncovered=uncovered,
        doubted=np.array([a.doubted for a in alignment.values()]),
        trusted=trusted(uncovered, residual),
    )
