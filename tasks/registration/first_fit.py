"""Every frame fitted by itself from its tracked pose, before anything is learned from all of them."""

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.registration.deformation_graph import DeformationGraph
from kinetree.schemas.registration.first_fit import FirstFit
from kinetree.schemas.registration.reference_colour import ReferenceColour
from kinetree.schemas.registration.tracking import Tracking
from kinetree.schemas.registration.vertex_colour import VertexColour
from kinetree.tasks.numerics.registration import first_fit as numerics
from kinetree.tasks.numerics.registration.correspondence import uncovered
from kinetree.tasks.numerics.registration.deformation import shape
from kinetree.tasks.numerics.registration.tracking import Tracking as Tracked
from kinetree.tasks.registration.pose import NO_COLOUR, NO_REFERENCE_COLOUR, fit_settings, graph, pose, target


@task(over="frame")
def first_fit(
    mesh: Mesh,
    deformation_graph: DeformationGraph,
    tracking: Tracking,
    vertex_colour: VertexColour = NO_COLOUR,
    reference_colour: ReferenceColour = NO_REFERENCE_COLOUR,
) -> FirstFit:
    """Fits a frame with all samples from its tracked pose, by the last steps of the fit that `tracking` sets (ours)."""
    body, near = graph(deformation_graph), pose(tracking)
    if tracking.steps == 0:  # the reference stays what it is
        fitted = Tracked(near, 0.0, 0)
    else:
        frame = target(mesh, deformation_graph, vertex_colour, reference_colour)
        if tracking.attempt > 0:  # fitted with all samples already
            fitted = Tracked(near, uncovered(*shape(body, near), body.F, frame), tracking.attempt - 1)
        else:
            fitted = numerics.first_fit(body, near, frame, fit_settings(tracking.fitting), tracking.usual)
    return FirstFit(
        rotation=fitted.pose.rotation,
        translation=fitted.pose.translation,
        uncovered=fitted.uncovered,
        attempt=fitted.attempt,
        fitting=tracking.fitting,
    )
