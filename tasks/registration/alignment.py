"""The reference mesh in one frame, with a confidence of every vertex."""

import numpy as np

from kinetree.errors import MeshError
from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.deformation_graph import DeformationGraph
from kinetree.schemas.registration.recovery import Recovery
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.registration.refit import Refit
from kinetree.tasks.numerics.registration.deformation import shape
from kinetree.tasks.numerics.registration.frame_confidence import stretches
from kinetree.tasks.numerics.registration.vertex_confidence import vertex_confidence
from kinetree.tasks.registration.pose import graph, pose, target


@task(over="frame")
def alignment(
    mesh: Mesh, reference: Reference, deformation_graph: DeformationGraph, recovery: Recovery, refit: tuple[Refit, ...]
) -> Alignment:
    """Bends the reference onto this frame by its pose of the last pass, with a confidence of every vertex (2014, Sec. 5.3)."""
    if not refit:
        return _given(mesh, reference)
    body = graph(deformation_graph)
    x, n = shape(body, pose(refit[-1]))
    estimate = vertex_confidence(body.V, x, n, body.F, target(mesh, deformation_graph), recovery.usual)
    return Alignment(
        vertices=x,
        residual=estimate.residual,
        stretch=estimate.stretch,
        confidence=estimate.confidence,
        uncovered=estimate.uncovered,
        distance=float(np.median(estimate.residual)),
        unreliable=float((estimate.confidence < 0.5).mean()),
    )


def _given(mesh: Mesh, reference: Reference) -> Alignment:
    """Fixed connectivity: every vertex is where the frame has it (2014, Sec. 7)."""
    rest, x = np.array(reference.vertices), np.array(mesh.vertices)
    if len(x) != len(rest) or not np.array_equal(mesh.faces, reference.faces):
        raise MeshError(
            f"{len(x)} vertices and {len(mesh.faces)} faces, but the frames that the body was learned from share one"
            f" connectivity of {len(rest)} and {len(reference.faces)}; leave the frame out, or learn from it as well"
            " (sequence.learn_from)"
        )
    return Alignment(
        vertices=x,
        residual=np.zeros(len(x)),
        stretch=stretches(rest, x, reference.faces.astype(np.int64)),
        confidence=np.ones(len(x)),
        uncovered=0.0,
        given=True,
    )
