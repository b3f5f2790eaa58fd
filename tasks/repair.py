"""Lost limbs found again: a suspect frame tried again from its other side."""

from kinetree.pipeline.task import task
from kinetree.schemas.mesh import Mesh
from kinetree.schemas.repair import Repair
from kinetree.schemas.suspects import Suspects
from kinetree.schemas.template import Template
from kinetree.schemas.tracking import Tracking
from kinetree.tasks.numerics.repair import Tracked, tracked
from kinetree.tasks.pose import graph, pose, target


@task(over="frame", along=Suspects)
def repair(mesh: Mesh, template: Template, tracking: Tracking, suspects: Suspects, previous: Repair | None) -> Repair:
    """Fits a suspect frame again from the pose beyond it and keeps what covers more of the frame (ours)."""
    found = Tracked(pose(tracking), tracking.uncovered, tracking.attempt)
    repaired = False
    if previous is not None and previous.uncovered < tracking.uncovered:
        again = tracked(graph(template), None, pose(previous), target(mesh, template), usual=suspects.usual)
        repaired = again.uncovered < tracking.uncovered
        found = again if repaired else found
    return Repair(
        steps=tracking.steps,
        rotation=found.pose.rotation,
        translation=found.pose.translation,
        uncovered=found.uncovered,
        repaired=repaired,
    )
