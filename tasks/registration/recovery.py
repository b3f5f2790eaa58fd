"""Lost limbs found again: a suspect frame tried again from its other side."""

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.registration.deformation_graph import DeformationGraph
from kinetree.schemas.registration.recovery import Recovery
from kinetree.schemas.registration.tracking import Tracking
from kinetree.schemas.registration.tracking_failures import TrackingFailures
from kinetree.tasks.numerics.registration.tracking import Tracked, tracked
from kinetree.tasks.registration.pose import graph, pose, target


@task(over="frame", along=TrackingFailures)
def recovery(
    mesh: Mesh, template: DeformationGraph, tracking: Tracking, suspects: TrackingFailures, previous: Recovery | None
) -> Recovery:
    """Fits a suspect frame again from the pose beyond it and keeps what covers more of the frame (ours)."""
    found = Tracked(pose(tracking), tracking.uncovered, tracking.attempt)
    repaired = False
    if previous is not None and previous.uncovered < tracking.uncovered:
        again = tracked(graph(template), None, pose(previous), target(mesh, template), usual=suspects.usual)
        repaired = again.uncovered < tracking.uncovered
        found = again if repaired else found
    return Recovery(
        steps=tracking.steps,
        rotation=found.pose.rotation,
        translation=found.pose.translation,
        uncovered=found.uncovered,
        repaired=repaired,
    )
