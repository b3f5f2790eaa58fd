"""How far the colours of the body explain those of a frame at the pose in which it was tracked (ours)."""

import numpy as np

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.registration.colour_term import ColourSettings, compared
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.registration.deformation import Pose, shape
from kinetree.tasks.numerics.registration.deformation_graph import DeformationGraph


def colour_agreement(graph: DeformationGraph, pose: Pose, target: Target) -> float:
    """The share of `compared` at the nearest points in place and normal alone: a fit by colours does not flatter itself.

    graph   : of the reference mesh
    pose    : of this frame
    target  : the frame, with colours
    returns : 0 to 1; 0 where there are no colours
    """
    if target.colour is None:
        return 0.0
    x, n = shape(graph, pose)
    there = target.nearest(x[graph.sample], n[graph.sample])
    return max(compared(target.colour, graph.N, target.N, graph.sample, there).share, 0.0)


def suffices(share: Floats, settings: ColourSettings | None = None) -> bool:
    """Whether the agreement (frame,) reaches the limit in more than half of the frames, at least one."""
    limit = (settings or ColourSettings()).agreement
    return bool(len(share) and np.median(share) >= limit)
