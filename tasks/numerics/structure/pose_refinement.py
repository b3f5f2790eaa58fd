"""A better pose for an uncertain frame: fitted to its surface, tried elsewhere, checked (2014, Sec. 7.3; ours)."""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure.articulated_frame import FramePose, SkinnedBody, chained, relative_rotations
from kinetree.tasks.numerics.structure.frame_poses import FramePosesSettings
from kinetree.tasks.numerics.structure.pose_hypotheses import pose_hypothesis
from kinetree.tasks.numerics.structure.surface_fit import SurfaceFitSettings, aligned_weight, fitted_to_surface
from kinetree.tasks.numerics.structure.surface_matches import searched, uncovered, visible_share


class PoseRefinementSettings(NamedTuple):
    """When a frame is fitted, and when the fit counts."""

    certain: float = 0.7
    """Confidence of a part below which its frame is fitted. Not recorded."""
    gain: float = 0.03
    """Share of the uncovered surface that a fit must cover to count. Not recorded."""
    strange_turn: float = float(np.deg2rad(60.0))
    """Radians: a part turns no farther than this from every turn it was seen in, unless it did before. Not recorded."""
    surface_confidence: float = 0.7
    """Confidence of a part that the frame's surface shows in full; it says little of roll. Not recorded."""
    fit: SurfaceFitSettings | None = None
    """Of the fit itself; its defaults if not given."""


class KnownPoses(NamedTuple):
    """The poses of all frames before any is refined.

    R          : (frame, part, 3, 3) from rest to each frame
    confidence : (frame, part) 0 to 1
    """

    R: Floats
    confidence: Floats


class RefinedPose(NamedTuple):
    """A frame's pose.

    moved         : whether it is another than before
    pose          : the pose
    confidence    : (part,) 0 to 1
    before, after : share of the frame's surface that the body leaves uncovered before and in this pose
    """

    moved: bool
    pose: FramePose
    confidence: Floats
    before: float
    after: float


def needs_refinement(confidence: Floats, settings: PoseRefinementSettings | None = None) -> Flags:
    """(…,) whether a frame needs a fit, from the confidence (…, part) of its parts."""
    return np.asarray((confidence < (settings or PoseRefinementSettings()).certain).any(axis=-1))


def refined_pose(
    body: SkinnedBody,
    start: FramePose,
    target: Target,
    aligned: Floats,
    confidence: Floats,
    known: KnownPoses,
    frame: int,
    settings: PoseRefinementSettings | None = None,
) -> RefinedPose:
    """The pose that covers the frame better than the one before by a margin, or the one before (2014, Sec. 7.3; ours).

    start      : the pose before
    target     : the frame
    aligned    : (vertex, xyz) where each vertex is aligned to, mesh unit
    confidence : (vertex,) of the aligned vertices, 0 to 1
    known      : all poses before
    frame      : the row of this frame in `known`
    """
    chosen = settings or PoseRefinementSettings()
    before = float(uncovered(body, target, searched(body, start, target)).mean())
    expected, sure = relative_rotations(start.R, body.parents), known.confidence[frame]
    weight = aligned_weight(body, confidence, sure, chosen.fit)
    best = fitted_to_surface(body, start, target, aligned, weight, expected, chosen.fit)
    found = searched(body, best, target)
    turn, seen = relative_rotations(known.R, body.parents), _seen(known.confidence, body.parents)
    unseen = _unseen_branches(body, sure, visible_share(body, target, found), chosen)
    other = pose_hypothesis(body, best, target, found, turn, seen, frame, unseen)
    if other is not None:
        other = fitted_to_surface(body, other, target, aligned, weight, relative_rotations(other.R, body.parents), chosen.fit)
        matches = searched(body, other, target)
        if uncovered(body, target, matches).mean() < uncovered(body, target, found).mean():
            best, found = other, matches
    strange = _strange(best, start, body.parents, turn, seen, chosen)
    if strange.any():
        kept = np.where((strange @ body.beyond)[:, None, None], expected, relative_rotations(best.R, body.parents))
        best = FramePose(chained(kept, body.parents), best.x)
        found = searched(body, best, target)
    after = float(uncovered(body, target, found).mean())
    if after > (1.0 - chosen.gain) * before:
        return RefinedPose(False, start, sure, before, before)
    above, share = np.maximum(body.parents, 0), visible_share(body, target, found)
    shown = chosen.surface_confidence * np.minimum(share, share[above]) ** 2
    return RefinedPose(True, best, np.maximum(sure, shown), before, after)


def _unseen_branches(body: SkinnedBody, sure: Floats, share: Floats, chosen: PoseRefinementSettings) -> Flags:
    """(part,) uncertain parts that the frame does not show where they are, and all parts below them; never the root."""
    first = (sure < chosen.certain) & (share < FramePosesSettings().seen)
    first[0] = False
    return np.asarray(first @ body.beyond)


def _seen(confidence: Floats, parents: Ints) -> Flags:
    """(frame, part) frames whose rotation serves others: the part and its parent were seen."""
    seen: Flags = np.minimum(confidence, confidence[:, np.maximum(parents, 0)]) >= FramePosesSettings().seen
    return seen


def _strange(
    pose: FramePose, start: FramePose, parents: Ints, turn: Floats, seen: Flags, chosen: PoseRefinementSettings
) -> Flags:
    """(part,) parts that turn as they were seen in no frame, and did not before."""
    strange = np.zeros(len(parents), np.bool_)
    new, old = (relative_rotations(p.R, parents) for p in (pose, start))
    for a in range(1, len(parents)):
        known = turn[seen[:, a], a]
        if len(known):
            angle, before = (_angles(known, p[a]).min() for p in (new, old))
            strange[a] = angle > max(chosen.strange_turn, before)
    return strange


def _angles(turns: Floats, R: Floats) -> Floats:
    """(rotation,) radians between rotations (rotation, 3, 3) and one."""
    cosine = (np.einsum("kxy,xy->k", turns, R) - 1.0) / 2.0
    return np.asarray(np.arccos(np.clip(cosine, -1.0, 1.0)))
