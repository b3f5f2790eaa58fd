"""The reference brought near one frame after the other, outwards in both directions."""

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
from kinetree.schemas.topology.extrema import Extrema
from kinetree.tasks.numerics.registration import tracking as numerics
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.registration.deformation import FitSettings, Pose, at_rest
from kinetree.tasks.numerics.registration.deformation_graph import DeformationGraph as Nodes
from kinetree.tasks.numerics.registration.limb_swing import FrameLimbs, swings
from kinetree.tasks.numerics.registration.near_pose import (
    NearPose,
    distant_points,
    is_lost,
    near_pose,
    nearest_pose,
    put_right,
    thinned_body,
    thinned_frame,
)
from kinetree.tasks.numerics.registration.tracking import stepped_back
from kinetree.tasks.registration.pose import (
    NO_COLOUR,
    NO_REFERENCE_COLOUR,
    fit_settings,
    graph,
    limbs_of,
    pose,
    stored_tracking,
    target,
)


@task(over="frame", along=TrackingOrder)
def tracking(
    mesh: Mesh,
    deformation_graph: DeformationGraph,
    take_entries: TakeEntries,
    previous: Tracking | None,
    params: TrackingParams,
    index: Index,
    tips: Extrema,
    vertex_colour: VertexColour = NO_COLOUR,
    reference_colour: ReferenceColour = NO_REFERENCE_COLOUR,
) -> Tracking:
    """Brings the reference near a frame, starting from its neighbour's pose (ours, for 2014, Eqs. 4 to 6)."""
    body = graph(deformation_graph)
    if previous is None:
        return stored_tracking(NearPose(at_rest(body), 0.0), at_rest(body), 0, 0.0, params, frames=(index[0], index[0]))
    last, cloud = pose(previous), thinned_body(body)
    points = thinned_frame(np.array(mesh.vertices), mesh.faces, body.size)
    is_entry, has_colours = index[0] in take_entries.frames, len(vertex_colour.colour) > 0 and len(reference_colour.colour) > 0
    # few points show too little of colours, and say nothing of where a body stands in another take
    near, attempt = None if is_entry or has_colours else near_pose(cloud, last, points), 0
    limbs = limbs_of(deformation_graph, tips)
    if near is not None and is_lost(near, previous.usual):
        near = nearest_pose(cloud, near, swings(cloud, last, *limbs), points)
    if near is None or is_lost(near, previous.usual):
        starts = _moved(last, take_entries, index[0]) if is_entry else []
        frame = target(mesh, deformation_graph, vertex_colour, reference_colour)
        fitted = _fitted(body, previous, starts, frame, fit_settings(params), index[0], limbs)
        near, attempt = NearPose(fitted.pose, distant_points(cloud, fitted.pose, points)), 1 + fitted.attempt
    right = put_right(cloud, near, limbs, points)
    if right is not near:
        near, attempt = right, 0
    # the reference is far from nothing, whatever the capture's holes
    usual = near.distant if previous.steps == 0 else min(previous.usual, near.distant)
    before, frames = near.pose if is_entry else last, (index[0], previous.frame)
    return stored_tracking(near, before, previous.steps + 1, usual, params, attempt, frames)


def _fitted(
    body: Nodes,
    previous: Tracking,
    starts: list[Pose],
    frame: Target,
    fitting: FitSettings,
    number: int,
    limbs: FrameLimbs,
) -> numerics.Tracking:
    """A frame fitted with all samples; in another take, from wherever the body may stand."""
    distant = usual = previous.usual  # what is far is uncovered too, so no frame on the way leaves less uncovered
    if starts:  # how the body moved before says nothing here
        return numerics.entered(body, starts, frame, fitting, usual, distant=distant, limbs=limbs)
    last, earlier = pose(previous), None
    if previous.steps > 0:
        ahead = (number - previous.frame) / (previous.frame - previous.earlier_frame)
        earlier = stepped_back(Pose(previous.earlier_rotation, previous.earlier_translation), last, ahead)
    return numerics.tracking(body, earlier, last, frame, fitting, usual, distant=distant, limbs=limbs)


def _moved(pose: Pose, entries: TakeEntries, frame: int) -> list[Pose]:
    """A pose where the body may stand in the take that is entered at a frame."""
    starts = np.flatnonzero(entries.entry == entries.frames.index(frame))
    motions = [(np.array(entries.rotation[k]), np.array(entries.shift[k])) for k in starts]
    return [Pose(R @ pose.rotation, pose.translation @ R.T + shift) for R, shift in motions]
