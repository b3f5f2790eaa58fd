"""A frame's pose by few points of both surfaces: near enough for a fit to begin with, in less than half of its time (ours).

In a chain every frame waits for the one before, so a chain should do no more than a next frame needs. Bodies and frames are
thinned to clouds of points, each with its nearest points in place and normal as neighbours; the graph's nodes stay.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.registration.correspondence import CorrespondenceSettings, Target
from kinetree.tasks.numerics.registration.deformation import FitSettings, Pose, bending, fit, shape
from kinetree.tasks.numerics.registration.deformation_graph import DeformationGraph
from kinetree.tasks.numerics.registration.limb_swing import FrameLimbs, clearly_less_bent, with_two_exchanged


class NearPoseSettings(NamedTuple):
    """How few points a near pose is fitted by. Chosen on a waving human and a wolf (every second frame)."""

    samples: int = 1000
    """Points of a frame. With 600 limbs seem lost in a half of the frames, which then are fitted with all points."""
    points: int = 1200
    """Points of the body, its nodes among them; a frame's point must not be far from all of them just by chance."""
    fewest: int = 300
    """Points beside the nodes, at least. Not varied."""
    neighbours: int = 8
    """Points to which the local search for matches goes on from each point. Not varied."""
    distance: float = 3.0 * CorrespondenceSettings().covered
    """From which distance to the body's points a point of the frame is far, share of √area; as `TrackingSettings.distance`."""
    spacings: float = 1.4
    """And from which multiple of the body's mean spacing of points: where it has few, a point may be far from all by chance."""
    lost: float = 0.003
    """Share of a frame's points that may be far beyond the usual; above it a limb is lost. As `TrackingSettings.distant`."""
    strained: float = 0.15
    """How far the graph bends where limbs may have been exchanged, shares of the area; see `put_right`. With exchanged limbs it
    bent by 0.93 to 1.2 in four frames of two runners, and by 0.18 in one of a walker whose legs are near each other (right:
    0.02). Below it time is spared, of few frames of people and of six in seven of a wolf: right limbs bend the graph
    by 0.1 to 0.25 in the median of a body, of a runner by 0.46."""
    less_bent: float = 0.9
    """How far it may bend with limbs exchanged, share of how far it bends as it is and of how far it bends fitted again from
    there. Right exchanges of these runners had 0.27 to 0.87 of the latter, wrong ones of recorded bodies 2.4 and more, of a
    third runner 0.92, which left more of the frame far away."""


FITTING = FitSettings(6, (0.2, 0.005), (0.08, 0.03), (0.04, 0.012), (0.05, 0.005), 30, searches=2, thin=1)
"""How a near pose is fitted. With four steps, or 15 conjugate-gradient steps instead of 30, a waving human loses limbs that the
whole fit must find again."""


class NearPose(NamedTuple):
    """A frame of the chain.

    pose    : Pose
    distant : share of the frame's points far from the body, 0 to 1; a lost limb has many
    """

    pose: Pose
    distant: float


def thinned_body(graph: DeformationGraph, settings: NearPoseSettings | None = None) -> DeformationGraph:
    """The body as a cloud of points: its nodes and some of its samples; faces there are none.

    graph   : of the reference mesh
    returns : the same nodes, edges and blocks, with the points as vertices; every point is a sample
    """
    chosen = settings or NearPoseSettings()
    others = max(chosen.points - len(graph.node), chosen.fewest)
    kept = np.unique(np.concatenate([graph.node, graph.sample[:: max(len(graph.sample) // others, 1)]]))
    V, N = graph.V[kept], graph.N[kept]
    beta = CorrespondenceSettings().beta * graph.size
    start, ring = _nearest_points(np.hstack([V, beta * N]), chosen.neighbours)
    return replace(
        graph,
        V=V,
        F=np.zeros((0, 3), np.int64),
        N=N,
        node=np.searchsorted(kept, graph.node),
        bound=graph.bound[kept],
        weight=graph.weight[kept],
        sample=np.arange(len(kept)),
        start=start,
        ring=ring,
        of_vertex=graph.of_vertex[kept],
    )


def thinned_frame(V: Floats, F: npt.NDArray[np.integer[Any]], size: float, settings: NearPoseSettings | None = None) -> Target:
    """A frame as a cloud of points spread over it; colours are left out.

    V, F    : (vertex, xyz) mesh unit · (face, corner) clean
    size    : √area of the reference body, mesh unit
    returns : Target with the points as vertices; every point is a sample
    """
    chosen = settings or NearPoseSettings()
    whole = Target.of(V, F, size, chosen.samples)
    x, n = whole.V[whole.sample], whole.N[whole.sample]
    start, ring = _nearest_points(np.hstack([x, whole.beta * n]), chosen.neighbours)
    return replace(whole, V=x, F=np.zeros((0, 3), np.int64), N=n, start=start, ring=ring, sample=np.arange(len(x)))


def near_pose(body: DeformationGraph, neighbour: Pose, frame: Target, settings: NearPoseSettings | None = None) -> NearPose:
    """Fit a thinned frame from its neighbour's pose by few steps (ours).

    body      : of `thinned_body`
    neighbour : pose of the neighbouring frame
    frame     : of `thinned_frame`
    """
    chosen = settings or NearPoseSettings()
    pose = fit(body, neighbour, frame, FITTING).pose
    return NearPose(pose, distant_points(body, pose, frame, chosen))


def nearest_pose(
    body: DeformationGraph, near: NearPose, starts: Sequence[Pose], frame: Target, settings: NearPoseSettings | None = None
) -> NearPose:
    """Fit a thinned frame from each of some poses too, and take what lies nearest; of those from the other poses that lie as
    near the first counts, unless another one bends clearly less (ours).

    near        : the frame as it was fitted from its neighbour's pose
    starts      : other poses, see `swings`; none leaves it as it is
    body, frame : as in `near_pose`
    """
    chosen = settings or NearPoseSettings()
    found = [near_pose(body, start, frame, chosen) for start in starts]
    least = min((one.distant for one in found), default=np.inf)
    if not least < near.distant:
        return near
    alike = [one for one in found if one.distant <= least + chosen.lost]
    return alike[clearly_less_bent(body, [one.pose for one in alike])]


def put_right(
    body: DeformationGraph, near: NearPose, limbs: FrameLimbs, frame: Target, settings: NearPoseSettings | None = None
) -> NearPose:
    """A near pose without exchanged limbs: a body whose legs are exchanged covers a frame too, but its graph bends more (ours).

    Where the graph bends much, pairs of limbs exchange their stems; what is no farther away, and bends less, counts. Repeated
    for as long as it helps, once for each limb at most.

    body, frame : as in `near_pose`
    limbs       : of the body, and those that this frame shows
    returns     : the same object where nothing was exchanged
    """
    chosen = settings or NearPoseSettings()
    most = max(near.distant, chosen.lost)
    for _ in range(len(limbs.rest)):
        bends = bending(body, near.pose)
        if bends <= chosen.strained * body.size**2:
            break
        exchanged = with_two_exchanged(body, near.pose, limbs.rest, limbs.frame)
        if not exchanged:
            break
        again, *fits = (near_pose(body, start, frame, chosen) for start in (near.pose, *exchanged))
        as_near = [one for one in fits if one.distant <= most]
        best = min(as_near, key=lambda one: bending(body, one.pose), default=again)
        if bending(body, best.pose) > chosen.less_bent * min(bends, bending(body, again.pose)):
            break
        near = best
    return near


def is_lost(near: NearPose, usual: float, settings: NearPoseSettings | None = None) -> bool:
    """Whether a limb may be lost, so that the frame must be fitted with all samples (ours).

    usual : smallest share of any frame between the reference and this one that is far from the body: holes of a capture
    """
    return near.distant > usual + (settings or NearPoseSettings()).lost


def distant_points(body: DeformationGraph, pose: Pose, frame: Target, settings: NearPoseSettings | None = None) -> float:
    """Share of a thinned frame's points that are far from all points of the body, 0 to 1 (ours)."""
    chosen = settings or NearPoseSettings()
    limit = max(chosen.distance, chosen.spacings / np.sqrt(len(body.V)))
    to_body = cKDTree(shape(body, pose)[0], balanced_tree=False).query(frame.V)[0]
    return float((to_body > limit * frame.size).mean())


def _nearest_points(z: Floats, count: int) -> tuple[Ints, Ints]:
    """(point + 1,) where each point's neighbours begin · (entry,) they themselves, itself among them, nearest first."""
    count = min(count + 1, len(z))
    near = cKDTree(z, balanced_tree=False).query(z, k=range(1, count + 1))[1]
    return np.arange(len(z) + 1) * count, near.astype(np.int64).ravel()
