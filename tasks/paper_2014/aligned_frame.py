"""The default's alignment in one frame, as Step III of the paper reads it."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.paper_2014.arap import Arap
from kinetree.schemas.paper_2014.interval_reference import IntervalReference
from kinetree.schemas.registration.alignment import Alignment
from kinetree.tasks.numerics.paper_2014.rigid_residual import rigid_residual


@task(over="interval/frame")
def aligned_frame(interval_reference: IntervalReference, alignment: Alignment, mesh: Mesh) -> Arap:
    """Takes the reference in this frame from the default's alignment, in place of mapping and ARAP (2014, Sec. 5.3)."""
    rest, x, area = (np.array(a) for a in (interval_reference.vertices, alignment.vertices, interval_reference.area))
    return Arap(
        vertices=x,
        residual=alignment.residual,
        stretch=alignment.stretch,
        confidence=alignment.confidence,
        uncovered=alignment.uncovered,
        rigid_residual=rigid_residual(rest, x, area, np.array(mesh.vertices), mesh.faces.astype(np.int64)),
    )
