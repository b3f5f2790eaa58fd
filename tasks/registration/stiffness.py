"""How stiff every edge of the deformation graph is, learned in every pass from the poses of the pass before."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import Previous, task
from kinetree.schemas.array import Index
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.registration.deformation_graph import DeformationGraph
from kinetree.schemas.registration.recovery import Recovery
from kinetree.schemas.registration.refit import Refit
from kinetree.schemas.registration.stiffness import Stiffness
from kinetree.schemas.registration.tracking import Tracking
from kinetree.tasks.numerics.input.frame_numbers import take_spans
from kinetree.tasks.numerics.registration.rigid_clusters import rigid_clusters
from kinetree.tasks.numerics.registration.stiffness import learned_stiffness, refit_pass
from kinetree.tasks.registration.pose import graph, pose, tracked_pose


@task(over="pass", along=DeformationGraph, among=Sequence)
def stiffness(
    deformation_graph: DeformationGraph,
    tracking: Mapping[int, Tracking],
    recovery: Recovery,
    refit: Previous[tuple[Refit, ...]],
    previous: Stiffness | None,
    index: Index,
) -> Stiffness:
    """Learns from all poses of the pass before which edges bend and which nodes move as one (ours)."""
    nodes = graph(deformation_graph)
    poses = [pose(r) for r in refit] or [tracked_pose(t, recovery, frame) for frame, t in tracking.items()]
    takes = take_spans(tuple(tracking))
    cluster = previous.cluster if previous is not None else np.full(len(nodes.node), -1)
    if refit_pass(index[0]).clusters:
        cluster = rigid_clusters(nodes, poses, takes=takes)
    return Stiffness(stiffness=learned_stiffness(nodes, poses, takes=takes), cluster=cluster)
