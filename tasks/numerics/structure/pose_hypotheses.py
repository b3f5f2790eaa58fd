"""Where a limb may be that surface calls for: as it was in other frames, or between them."""

import numpy as np
from scipy.spatial import cKDTree

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure.articulated_frame import Body, Posture, against_parents, chained, limbs, surface
from kinetree.tasks.numerics.structure.frame_poses import between
from kinetree.tasks.numerics.structure.surface_matches import Matches, unexplained

TRIED = 24  # frames from which a limb's turning is tried
REACH = 0.1  # distance from which on a point explains nothing at all, share of the body's size
NEAR = 0.03  # as near as this in place and direction the rest of the body explains a point
FEW = 0.005  # share of a frame that may be left over anywhere
BETTER = 0.8  # a guess leaves at most this share of what the posture leaves


def guess(
    body: Body, at: Posture, target: Target, found: Matches, turn: Floats, known: Flags, frame: int, doubted: Flags
) -> Posture | None:
    """The posture with its doubted limbs as they were in the frame in which they explain what is left over; None if none do.

    turn, known : (frame, part, 3, 3) against the parents · (frame, part) where each was seen
    frame       : the row that is to be guessed
    doubted     : (part,) what may be elsewhere, with all that hangs on it
    """
    piece = limbs(body.parents, doubted)
    if (unexplained(body, target, found) >= 1.0).mean() < FEW or piece.max(initial=-1) < 0:
        return None
    best, changed = against_parents(at.R, body.parents), False
    for number in range(piece.max() + 1):
        parts = np.flatnonzero(piece == number)
        ways = _ways(turn, known, frame, parts)
        mine = np.isin(body.label[body.asked], np.flatnonzero(body.beyond[parts].any(axis=0)))
        over = _points(target)[_away(found.x, found.n, target, body.asked[~mine], _points(target)) > NEAR * body.size]
        tried = [surface(body, Posture(chained(_with(best, parts, way), body.parents), at.x)) for way in [best[parts], *ways]]
        left = [np.minimum(_away(x, n, target, body.asked[mine], over) / (REACH * body.size), 1.0).sum() for x, n in tried]
        chosen = int(np.argmin(left))
        if left[chosen] < BETTER * left[0]:
            best, changed = _with(best, parts, ways[chosen - 1]), True
    return Posture(chained(best, body.parents), at.x) if changed else None


def _ways(turn: Floats, known: Flags, frame: int, parts: Ints) -> list[Floats]:
    """Turnings (part, 3, 3) of one limb: between the nearest frames that saw each part, and as in frames that saw them all."""
    middle = np.stack([between(turn[:, a], known[:, a] & (np.arange(len(turn)) != frame))[frame] for a in parts])
    seen = np.flatnonzero(known[:, parts].all(axis=1))
    some = seen[np.linspace(0, len(seen) - 1, min(TRIED, len(seen))).astype(np.int64)] if len(seen) else seen
    return [middle, *(turn[k, parts] for k in some)]


def _with(turn: Floats, parts: Ints, way: Floats) -> Floats:
    changed = turn.copy()
    changed[parts] = way
    return changed


def _points(target: Target) -> Floats:
    """(sample, 6) the frame's samples as places and directions."""
    points: Floats = np.hstack([target.V[target.sample], target.beta * target.N[target.sample]])
    return points


def _away(x: Floats, n: Floats, target: Target, mine: Ints, points: Floats) -> Floats:
    """(point,) distance to the nearest of some of the body's vertices in place and direction, mesh unit."""
    if not len(mine):
        return np.full(len(points), np.inf)
    return np.asarray(cKDTree(np.hstack([x[mine], target.beta * n[mine]])).query(points)[0])
