"""The reference mesh in one frame, and how far it is to be believed there."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.deformation_graph import DeformationGraph
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.registration.refit import ThirdRefit
from kinetree.schemas.registration.tracking_failures import TrackingFailures
from kinetree.tasks.numerics.registration.deformation import shape
from kinetree.tasks.numerics.registration.frame_confidence import stretches
from kinetree.tasks.numerics.registration.vertex_confidence import vertex_confidence
from kinetree.tasks.registration.pose import graph, pose, target


@task(over="frame")
def alignment(
    mesh: Mesh, reference: Reference, template: DeformationGraph, refit: ThirdRefit, suspects: TrackingFailures
) -> Alignment:
    """Puts every vertex of the reference where it is in this frame, and says how far to believe that (2014, Sec. 5.3)."""
    if reference.fixed:
        return _given(mesh, reference)
    body = graph(template)
    x, n = shape(body, pose(refit))
    found = vertex_confidence(body.V, x, n, body.F, target(mesh, template), suspects.usual)
    return Alignment(
        vertices=x,
        residual=found.residual,
        stretch=found.stretch,
        trust=found.trust,
        uncovered=found.uncovered,
        distance=float(np.median(found.residual)),
        doubted=float((found.trust < 0.5).mean()),
    )


def _given(mesh: Mesh, reference: Reference) -> Alignment:
    """Fixed connectivity: every vertex is where the frame has it (2014, Sec. 7)."""
    rest, x = np.array(reference.vertices), np.array(mesh.vertices)
    return Alignment(
        vertices=x,
        residual=np.zeros(len(x)),
        stretch=stretches(rest, x, reference.faces.astype(np.int64)),
        trust=np.ones(len(x)),
        uncovered=0.0,
    )
