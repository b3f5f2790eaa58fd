"""Poses of frames in which a body holds its limbs alike, to begin a frame with that a chain reached wrongly (ours).

A chain that has exchanged two limbs, or lost one, hands that on to all frames beyond, and no frame beside them knows better.
But bodies come back to poses that they had: a runner at every stride. Frames with their limbs alike were reached along other
ways, and the body bends as far in all of them; one in which it bends clearly farther may be wrong, though it is covered.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.registration.deformation import Pose, bending
from kinetree.tasks.numerics.registration.deformation_graph import DeformationGraph
from kinetree.tasks.numerics.registration.near_pose import NearPose, NearPoseSettings, near_pose, thinned_frame
from kinetree.tasks.numerics.registration.take_entries import Limbs, likely_turns, unturned


class AlikePosesSettings(NamedTuple):
    """Which frames are alike, and which poses are begun with."""

    looked_at: int = 8
    """Frames whose limbs lie most alike, whatever the place and direction, that are compared with a frame."""
    apart: float = 0.06
    """Mean distance between the limbs of alike frames, share of the body's size, at most: 0.010 to 0.025 between four frames of
    two people with exchanged limbs and those that put them right. Farther apart, right frames bend unalike."""
    farther: float = 1.3
    """How many times as far as in an alike frame the body bends from which on a frame is looked through: in those four frames
    1.36 to 2.4 times, in right ones seldom more than 1.3 times."""
    strained: float = NearPoseSettings().strained
    """How far it bends, share of the area, below which no frame is looked through; see there."""
    less: float = 0.9
    """How far it may bend fitted from an alike frame by few points, share of how far it does from its own pose."""


def alike_frames(limbs: Sequence[Limbs], settings: AlikePosesSettings | None = None) -> list[Ints]:
    """By frame, the positions of those whose limbs lie most alike, the most alike first; frames with as many limbs alone.

    limbs : (frame,)
    """
    chosen, found = settings or AlikePosesSettings(), [np.zeros(0, np.int64) for _ in limbs]
    counts = np.array([len(one.stems) for one in limbs])
    for count in np.unique(counts[counts > 0]).tolist():
        own = np.flatnonzero(counts == count)
        lengths = np.stack([unturned(limbs[t]) for t in own.tolist()])
        near = min(chosen.looked_at + 1, len(own))
        for t, row in zip(own.tolist(), cKDTree(lengths).query(lengths, k=range(1, near + 1))[1], strict=True):
            others = own[row]
            found[t] = others[others != t][: chosen.looked_at]
    return found


def looked_through(
    bends: Floats, alike: Sequence[Ints], failed: Flags, least: float, settings: AlikePosesSettings | None = None
) -> list[tuple[int, Ints]]:
    """Frames that may be wrong, those that bend farthest first, and the alike ones that are better.

    bends  : (frame,) how far the body bends, mesh unit²
    alike  : by frame, see `alike_frames`
    failed : (frame,) frames that are not covered; any other may be better
    least  : how far it bends at least, mesh unit²
    """
    chosen, found = settings or AlikePosesSettings(), []
    for t in np.argsort(-bends, kind="stable").tolist():
        others = alike[t][~failed[alike[t]]]
        better = others if failed[t] else others[chosen.farther * bends[others] < bends[t]]
        if len(better) and (failed[t] or bends[t] > least):
            found.append((t, better))
    return found


def entry(
    body: DeformationGraph,
    own: Pose,
    frame: Target,
    limbs: Sequence[Limbs],
    at: int,
    others: Ints,
    pose: Callable[[int], Pose],
    settings: AlikePosesSettings | None = None,
    *,
    failed: bool = False,
) -> Pose | None:
    """The pose from the most alike frame by which a thinned body covers a frame better, or as well and bends clearly less.

    None where there is none. Turns of the body that bring its limbs as near are all tried (`likely_turns`).

    body   : of `thinned_body`
    own    : the pose that the frame has
    frame  : prepared, with all points
    limbs  : of all frames
    at     : position of the frame
    others : positions of the alike ones
    pose   : gives the pose at a position
    failed : whether the frame's own pose leaves much of it uncovered; if not, one that bends no less is not better
    """
    chosen, lost = settings or AlikePosesSettings(), NearPoseSettings().lost
    turns = {u: likely_turns(limbs[u], limbs[at]) for u in others.tolist()}
    left, u = min(((float(distance[0]), u) for u, (_, distance) in turns.items()), default=(np.inf, -1))
    if left > chosen.apart:
        return None
    points = thinned_frame(frame.V, frame.F, body.size)
    starts = [_moved(pose(u), R, limbs[u], limbs[at]) for R in turns[u][0]]
    found = [near_pose(body, start, points) for start in starts]

    def bent(one: NearPose) -> float:
        return bending(body, one.pose)

    least = min(one.distant for one in found)
    best = min((one for one in found if one.distant <= least + lost), key=bent)
    if not failed and bent(best) > chosen.less * bending(body, own):
        return None  # fitted again by few points, its own pose bends no farther
    again = near_pose(body, own, points)
    covers = again.distant > best.distant + lost
    return best.pose if covers or (best.distant <= again.distant + lost and bent(best) < chosen.less * bent(again)) else None


def _moved(pose: Pose, R: Floats, there: Limbs, here: Limbs) -> Pose:
    """The pose turned about the centre of one frame and brought to that of another one."""
    return Pose(R @ pose.rotation, (pose.translation - there.centre) @ R.T + here.centre)
