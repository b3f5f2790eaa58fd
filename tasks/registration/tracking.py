"""The reference bent onto one frame after the other, outwards in both directions."""

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.registration.deformation_graph import DeformationGraph
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.registration.tracking import Tracking
from kinetree.tasks.numerics.registration.deformation import Pose, at_rest
from kinetree.tasks.numerics.registration.tracking import Tracked, tracked
from kinetree.tasks.registration.pose import graph, pose, target


@task(over="frame", along=Reference)
def tracking(mesh: Mesh, template: DeformationGraph, previous: Tracking | None) -> Tracking:
    """Bends the reference onto a frame, starting from its neighbour's pose (ours, for 2014, Eqs. 4 to 6)."""
    body = graph(template)
    if previous is None or not len(body.node):
        rest = at_rest(body)
        return _told(Tracked(rest, 0.0, 0), rest, 0 if previous is None else previous.steps + 1, 0.0)
    last = pose(previous)
    earlier = Pose(previous.earlier_rotation, previous.earlier_translation) if previous.steps > 0 else None
    found = tracked(body, earlier, last, target(mesh, template), usual=previous.usual)
    # the reference leaves nothing uncovered, whatever the capture's holes
    usual = found.uncovered if previous.steps == 0 else min(previous.usual, found.uncovered)
    return _told(found, last, previous.steps + 1, usual)


def _told(found: Tracked, earlier: Pose, steps: int, usual: float) -> Tracking:
    return Tracking(
        steps=steps,
        rotation=found.pose.rotation,
        translation=found.pose.translation,
        uncovered=found.uncovered,
        usual=usual,
        attempt=found.attempt,
        earlier_rotation=earlier.rotation,
        earlier_translation=earlier.translation,
    )
