"""The reference bent onto one frame after the other, outwards in both directions."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.array import Index
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.registration.deformation_graph import DeformationGraph
from kinetree.schemas.registration.reference_colour import ReferenceColour
from kinetree.schemas.registration.take_entries import TakeEntries
from kinetree.schemas.registration.tracking import Tracking, TrackingParams
from kinetree.schemas.registration.tracking_order import TrackingOrder
from kinetree.schemas.registration.vertex_colour import VertexColour
from kinetree.tasks.numerics.registration import tracking as numerics
from kinetree.tasks.numerics.registration.deformation import Pose, at_rest
from kinetree.tasks.registration.pose import NO_COLOUR, NO_REFERENCE_COLOUR, fit_settings, graph, pose, stored_tracking, target


@task(over="frame", along=TrackingOrder)
def tracking(
    mesh: Mesh,
    deformation_graph: DeformationGraph,
    take_entries: TakeEntries,
    previous: Tracking | None,
    params: TrackingParams,
    index: Index,
    vertex_colour: VertexColour = NO_COLOUR,
    reference_colour: ReferenceColour = NO_REFERENCE_COLOUR,
) -> Tracking:
    """Bends the reference onto a frame, starting from its neighbour's pose (ours, for 2014, Eqs. 4 to 6)."""
    body = graph(deformation_graph)
    if previous is None:
        rest = at_rest(body)
        return stored_tracking(numerics.Tracking(rest, 0.0, 0), rest, 0, 0.0, params)
    last = pose(previous)
    earlier = Pose(previous.earlier_rotation, previous.earlier_translation) if previous.steps > 0 else None
    frame, fitting = target(mesh, deformation_graph, vertex_colour, reference_colour), fit_settings(params)
    is_entry = index[0] in take_entries.frames
    if is_entry:  # another take: the body stands elsewhere, and how it moved before says nothing
        fitted = numerics.entered(body, _moved(last, take_entries, index[0]), frame, fitting, usual=previous.usual)
    else:
        fitted = numerics.tracking(body, earlier, last, frame, fitting, usual=previous.usual)
    # the reference leaves nothing uncovered, whatever the capture's holes
    usual = fitted.uncovered if previous.steps == 0 else min(previous.usual, fitted.uncovered)
    return stored_tracking(fitted, fitted.pose if is_entry else last, previous.steps + 1, usual, params)


def _moved(pose: Pose, entries: TakeEntries, frame: int) -> list[Pose]:
    """A pose where the body may stand in the take that is entered at a frame."""
    starts = np.flatnonzero(entries.entry == entries.frames.index(frame))
    motions = [(np.array(entries.rotation[k]), np.array(entries.shift[k])) for k in starts]
    return [Pose(R @ pose.rotation, pose.translation @ R.T + shift) for R, shift in motions]
