"""Which frames of an alignment are to be believed."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.alignment import Alignment
from kinetree.schemas.reference import Reference
from kinetree.schemas.trust import Trust
from kinetree.tasks.numerics.trust import trusted


@task()
def trust(alignment: Mapping[int, Alignment], reference: Reference) -> Trust:
    """Compares what the frames say of themselves and marks those that stand out (ours)."""
    residual = np.array([a.distance for a in alignment.values()]) / reference.size
    uncovered = np.array([a.uncovered for a in alignment.values()])
    return Trust(
        frames=tuple(alignment),
        residual=residual,
        uncovered=uncovered,
        doubted=np.array([a.doubted for a in alignment.values()]),
        trusted=trusted(uncovered, residual),
    )
