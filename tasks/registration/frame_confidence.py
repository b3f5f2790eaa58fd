"""Which frames the alignment explains."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.frame_confidence import FrameConfidence
from kinetree.tasks.numerics.registration.frame_confidence import inliers


@task()
def frame_confidence(alignment: Mapping[int, Alignment], mesh: Mapping[int, Mesh], sequence: Sequence) -> FrameConfidence:
    """Compares residuals and uncovered shares of all frames and marks the frames that stand out (ours)."""
    learned = np.isin(tuple(alignment), sequence.learned)
    size = float(np.sqrt(np.median(np.array([m.cleaning.area for m in mesh.values()])[learned])))
    residual = np.array([a.distance for a in alignment.values()]) / size
    uncovered = np.array([a.uncovered for a in alignment.values()])
    return FrameConfidence(
        frames=tuple(alignment),
        residual=residual,
        uncovered=uncovered,
        unreliable=np.array([a.unreliable for a in alignment.values()]),
        inlier=inliers(uncovered, residual, usual=learned),
    )
