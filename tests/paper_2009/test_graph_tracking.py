"""Contract of graph_tracking: the surface lies on every frame, nearer than the nodes alone carry it."""

import numpy as np
from volumetric import volumetric

from kinetree.schemas.paper_2009.graph_tracking import GraphTrackingParams
from kinetree.tasks.numerics.geometry.closest_point import projected
from kinetree.tasks.numerics.registration.deformation import shape
from kinetree.tasks.paper_2009.graph_tracking import graph_tracking
from kinetree.tasks.registration.pose import graph, pose


def test_surface_is_bent_onto_the_frame_where_the_nodes_carry_it_past() -> None:
    here = volumetric()
    one, body = here.integrated_structure, graph(here.deformation_graph)
    frame = next(t for t in one.frames if abs(t - one.frame) == 1)
    past = np.array(here.graph_motion[frame].vertices) + [0.5, 0.0, 0.0]
    motion = here.graph_motion[frame].model_copy(update={"vertices": past})
    before = here.graph_tracking[one.frame]
    at = graph_tracking(here.mesh[frame], here.deformation_graph, one, motion, before, GraphTrackingParams())
    carried, bent = (projected(x, here.body.x[frame], here.body.F).distance.mean() for x in (past, shape(body, pose(at))[0]))
    assert bent < 0.3 * carried
    assert at.steps == 1


def test_reference_is_left_as_it_is() -> None:
    here = volumetric()
    at = here.graph_tracking[here.integrated_structure.frame]
    assert np.array_equal(at.translation, graph(here.deformation_graph).g)
    assert at.unexplained == 0.0
