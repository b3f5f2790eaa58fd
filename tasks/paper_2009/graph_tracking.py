"""The surface of the integrated structure bent onto each frame, from where the structure's nodes carry it."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.paper_2009.graph_motion import GraphMotion
from kinetree.schemas.paper_2009.graph_tracking import GraphTrackingParams
from kinetree.schemas.paper_2009.integrated_structure import IntegratedStructure
from kinetree.schemas.registration.deformation_graph import DeformationGraph
from kinetree.schemas.registration.tracking import Tracking
from kinetree.schemas.registration.tracking_order import TrackingOrder
from kinetree.tasks.numerics.paper_2009 import graph_tracking as numerics
from kinetree.tasks.numerics.registration.deformation import at_rest
from kinetree.tasks.numerics.registration.near_pose import NearPose
from kinetree.tasks.numerics.registration.tracking import Tracking as Tracked
from kinetree.tasks.registration.pose import fit_settings, graph, pose, stored_tracking, target


@task(over="frame", along=TrackingOrder)
def graph_tracking(
    mesh: Mesh,
    deformation_graph: DeformationGraph,
    integrated_structure: IntegratedStructure,
    graph_motion: GraphMotion,
    previous: Tracking | None,
    params: GraphTrackingParams,
) -> Tracking:
    """Bends the surface that the nodes carry onto a frame's: the volumetric fit that the paper asks for (2009, Sec. 3.2, 4)."""
    body, last, usual, steps = graph(deformation_graph), None, 0.0, 0
    if previous is None:
        fitted = Tracked(at_rest(body), 0.0, 0)
    else:
        last, steps = pose(previous), previous.steps + 1
        bound, weight = np.array(integrated_structure.bound), np.array(integrated_structure.weight)
        carried = numerics.carried_pose(
            body.node, bound, weight, np.array(graph_motion.rotation), np.array(graph_motion.vertices)
        )
        frame = target(mesh, deformation_graph)
        fitted = numerics.graph_tracking(body, carried, last, frame, fit_settings(params), previous.usual)
        usual = fitted.uncovered if previous.steps == 0 else min(previous.usual, fitted.uncovered)
    earlier = last or fitted.pose
    near = NearPose(fitted.pose, fitted.uncovered)  # with all samples: what is uncovered is known
    return stored_tracking(near, earlier, steps, usual, params, 1 + fitted.attempt)
