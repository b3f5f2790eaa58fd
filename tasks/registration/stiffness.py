"""How stiff every edge of the deformation graph is, learned in every pass from the poses of the pass before."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import Previous, task
from kinetree.schemas.array import Index
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.registration.deformation_graph import DeformationGraph
from kinetree.schemas.registration.first_fit import FirstFit
from kinetree.schemas.registration.recovery import Recovery
from kinetree.schemas.registration.refit import Refit
from kinetree.schemas.registration.stiffness import Stiffness
from kinetree.tasks.numerics.input.frame_numbers import take_spans
from kinetree.tasks.numerics.registration.rigid_clusters import rigid_clusters
from kinetree.tasks.numerics.registration.stiffness import learned_stiffness, refit_pass
from kinetree.tasks.registration.pose import first_pose, graph, pose


@task(over="pass", along=DeformationGraph, among=Sequence)
def stiffness(
    deformation_graph: DeformationGraph,
    first_fit: Mapping[int, FirstFit],
    recovery: Recovery,
    refit: Previous[tuple[Refit, ...]],
    previous: Stiffness | None,
    index: Index,
) -> Stiffness:
    """Learns from all poses of the pass before which edges bend and which nodes move as one (ours)."""
    nodes = graph(deformation_graph)
    poses = [pose(r) for r in refit] or [first_pose(f, recovery, frame) for frame, f in first_fit.items()]
    takes = take_spans(tuple(first_fit))
    cluster = previous.cluster if previous is not None else np.full(len(nodes.node), -1)
    if refit_pass(index[0]).clusters:
        cluster = rigid_clusters(nodes, poses, takes=takes)
    return Stiffness(stiffness=learned_stiffness(nodes, poses, takes=takes), cluster=cluster)
