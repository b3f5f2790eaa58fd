"""The mesh of the integrated structure in one frame, as the alignment that every method ends with."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.paper_2009.graph_motion import GraphMotion
from kinetree.schemas.registration.alignment import Alignment


@task(over="frame")
def graph_alignment(graph_motion: GraphMotion) -> Alignment:
    """Takes the surface as the nodes carry it (ours, for 2009, Sec. 2.5)."""
    m = graph_motion
    return Alignment(
        vertices=m.vertices,
        residual=m.residual,
        stretch=m.stretch,
        confidence=m.confidence,
        uncovered=m.uncovered,
        distance=float(np.median(m.residual)),
        unreliable=float((m.confidence < 0.5).mean()),
    )
