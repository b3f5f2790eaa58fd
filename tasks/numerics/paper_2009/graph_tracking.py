"""The surface that the nodes of a structure carry, bent onto a frame (for 2009, Sec. 3.2 and 4: the volumetric fit; ours)."""

from typing import Any

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.registration.correspondence import Target, uncovered
from kinetree.tasks.numerics.registration.deformation import FitSettings, Pose, fit, shape
from kinetree.tasks.numerics.registration.deformation_graph import DeformationGraph
from kinetree.tasks.numerics.registration.tracking import Tracking, TrackingSettings, tracking

CARRIED = -1
"""Number of the way that starts where the structure's nodes carry the surface."""


def graph_tracking(
    graph: DeformationGraph, carried: Pose, neighbour: Pose, target: Target, fitting: FitSettings, usual: float = 0.0
) -> Tracking:
    """The deformation graph fitted from where the structure carries it; if that fails, also from the neighbouring frame.

    graph     : of the structure's mesh
    carried   : its pose by the structure's nodes, see `carried_pose`
    neighbour : its pose in the frame before it in the traversal
    fitting   : how it is fitted
    usual     : smallest share that any frame between the initial one and this leaves uncovered
    returns   : Tracking of the start that leaves the least of the frame uncovered, `CARRIED` being the first
    """
    pose = fit(graph, carried, target, fitting).pose
    own = Tracking(pose, uncovered(*shape(graph, pose), graph.F, target), CARRIED)
    if own.uncovered <= usual + TrackingSettings().uncovered:
        return own
    return min(own, tracking(graph, None, neighbour, target, fitting, usual), key=lambda way: way.uncovered)


def carried_pose(
    node: npt.NDArray[np.integer[Any]], bound: npt.NDArray[np.integer[Any]], weight: Floats, R: Floats, x: Floats
) -> Pose:
    """The pose of a deformation graph whose nodes go with a structure's surface.

    node          : (node,) vertex that each node of the deformation graph lies on
    bound, weight : (vertex, 4) nodes of the structure that each vertex follows · how much, summing to 1
    R, x          : (structure's node, 3, 3) its rotations · (vertex, xyz) where it carries the surface, mesh unit
    """
    blend = np.einsum("nk,nkxy->nxy", weight[node], R[bound[node]])
    U, _, W = np.linalg.svd(blend)
    mirrored = np.ones((len(node), 3))
    mirrored[:, 2] = np.sign(np.linalg.det(U @ W))
    return Pose(np.ascontiguousarray((U * mirrored[:, None]) @ W), np.ascontiguousarray(x[node]))
