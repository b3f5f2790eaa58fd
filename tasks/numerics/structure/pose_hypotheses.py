"""Where a limb may be that the frame does not show where it is: as in other frames, or between them (ours)."""

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure.articulated_frame import (
    FramePose,
    SkinnedBody,
    chained,
    limbs,
    relative_rotations,
    surface,
)
from kinetree.tasks.numerics.structure.frame_poses import interpolated
from kinetree.tasks.numerics.structure.surface_matches import Matches, uncovered


class PoseHypothesesSettings(NamedTuple):
    """Which poses of a limb are tried and when one counts; lengths are shares of the root of the area."""

    frames: int = 24
    """Frames whose pose of a limb is tried, evenly many of those that saw it. Not recorded; for time."""
    reach: float = 0.1
    """Distance from which on a vertex covers nothing of a point. Not recorded."""
    near: float = 0.03
    """Distance in place and direction up to which the rest of the body covers a point. Not recorded."""
    least_uncovered: float = 0.005
    """Share of a frame that must be uncovered for anything to be tried. Not recorded."""
    better: float = 0.8
    """Share of the uncovered points that a hypothesis leaves at most, against the pose so far. Not recorded."""


def pose_hypothesis(
    body: SkinnedBody,
    pose: FramePose,
    target: Target,
    found: Matches,
    turn: Floats,
    known: Flags,
    frame: int,
    unseen: Flags,
    settings: PoseHypothesesSettings | None = None,
) -> FramePose | None:
    """The pose with its unseen limbs as they were in the frame in which they cover most of what is uncovered.

    found   : matches of the pose with the frame
    turn    : (frame, part, 3, 3) rotations against the parents
    known   : (frame, part) where each part was seen
    frame   : the row of this frame
    unseen  : (part,) parts that may be elsewhere, with all parts below them
    returns : None where too little is uncovered or no limb covers it better elsewhere
    """
    chosen = settings or PoseHypothesesSettings()
    limb = limbs(body.parents, unseen)
    if (uncovered(body, target, found) >= 1.0).mean() < chosen.least_uncovered or limb.max(initial=-1) < 0:
        return None
    best, changed, points = relative_rotations(pose.R, body.parents), False, _points(target)
    for number in range(limb.max() + 1):
        parts = np.flatnonzero(limb == number)
        candidates = _candidates(turn, known, frame, parts, chosen.frames)
        own = np.isin(body.label[body.sample], np.flatnonzero(body.beyond[parts].any(axis=0)))
        rest = points[_distance(found.x, found.n, target, body.sample[~own], points) > chosen.near * body.size]
        cost = []
        for candidate in [best[parts], *candidates]:
            x, n = surface(body, FramePose(chained(_replaced(best, parts, candidate), body.parents), pose.x))
            away = _distance(x, n, target, body.sample[own], rest) / (chosen.reach * body.size)
            cost.append(np.minimum(away, 1.0).sum())
        cheapest = int(np.argmin(cost))
        if cost[cheapest] < chosen.better * cost[0]:
            best, changed = _replaced(best, parts, candidates[cheapest - 1]), True
    return FramePose(chained(best, body.parents), pose.x) if changed else None


def _candidates(turn: Floats, known: Flags, frame: int, parts: Ints, most: int) -> list[Floats]:
    """Rotations (part, 3, 3) of one limb: between the nearest frames that saw each part, and of frames that saw them all."""
    others = np.arange(len(turn)) != frame
    between = np.stack([interpolated(turn[:, a], known[:, a] & others)[frame] for a in parts])
    seen = np.flatnonzero(known[:, parts].all(axis=1))
    tried = seen[np.linspace(0, len(seen) - 1, min(most, len(seen))).astype(np.int64)] if len(seen) else seen
    return [between, *(turn[k, parts] for k in tried)]


def _replaced(turn: Floats, parts: Ints, candidate: Floats) -> Floats:
    """Rotations with those of some parts replaced."""
    changed = turn.copy()
    changed[parts] = candidate
    return changed


def _points(target: Target) -> Floats:
    """(sample, 6) the frame's samples as places and directions."""
    points: Floats = np.hstack([target.V[target.sample], target.beta * target.N[target.sample]])
    return points


def _distance(x: Floats, n: Floats, target: Target, vertices: Ints, points: Floats) -> Floats:
    """(point,) distance to the nearest of some of the body's vertices in place and direction, mesh unit."""
    if not len(vertices):
        return np.full(len(points), np.inf)
    return np.asarray(cKDTree(np.hstack([x[vertices], target.beta * n[vertices]])).query(points)[0])
