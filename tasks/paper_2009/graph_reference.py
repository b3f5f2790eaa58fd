"""The mesh of the integrated structure, as the reference that the surface of every frame is fitted with."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.paper_2009.coherent_intervals import CoherentIntervals
from kinetree.schemas.paper_2009.integrated_structure import IntegratedStructure
from kinetree.schemas.registration.reference import Reference


@task()
def graph_reference(integrated_structure: IntegratedStructure, intervals: CoherentIntervals) -> Reference:
    """Takes the initial frame of the integrated structure as reference (ours, for 2009, Sec. 3.2 and 4)."""
    s = integrated_structure
    at = s.frames.index(s.frame)
    return Reference(
        frames=s.frames,
        frame=s.frame,
        fixed=False,
        leaves=int(intervals.ends.max(initial=0)),
        free=bool(intervals.coherent[at]),
        loop=float(intervals.reach[at]),
        vertices=s.vertices,
        faces=s.faces,
        size=s.size,
        stems=np.zeros((0, 1, 3)),
        score=intervals.spread,
    )
