"""What frames show of a hinge at a ring across the last part of a limb (ours, see `end_joints`)."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.structure.hinged_piece import HingedFit

FEWEST_PAIRS = 3
"""Pairs of frames that follow each other, below which nothing is said of a ring, by halves neither."""

RUN = 3
"""Pairs of frames that follow each other without a gap, of takes with too many frames: 39 pairs are 52 frames then, and would
be 78 one by one."""


class RingEvidence(NamedTuple):
    """What a ring shows over some frames.

    score     : see `ring_score`; by neighbouring frames, or by two halves of what lies beyond the ring
    gain      : how many times more is left of the part as one piece than with the hinge
    far, near : root mean square turn of the hinge, and of the nearer piece against the part above, as far as it agrees from
                frame to frame; by halves, of the hinge as far as these agree, of the nearer piece all of it; degrees
    """

    score: float
    gain: float
    far: float
    near: float


def ring_evidence(above: Floats, fits: Mapping[int, HingedFit], steady: Mapping[int, float], pairs: Ints) -> RingEvidence:
    """What a ring shows; nothing in few frames.

    above  : (frame, 3, 3) the motion of the part above, from the reference
    fits   : by frame, how the part lies
    steady : by frame, mean squared distance of the part with its hinge held, mesh unit²
    pairs  : (pair, 2) frames that follow each other
    """
    both = np.array([(a, b) for a, b in pairs.tolist() if a in fits and b in fits], dtype=np.int64)
    if len(both) < FEWEST_PAIRS:
        return RingEvidence(0.0, 0.0, 0.0, 0.0)
    far = about_mean({f: fit.pose.Q for f, fit in fits.items()})
    near = about_mean({f: above[f].T @ fit.pose.R for f, fit in fits.items()})
    held, two = np.array([steady[f] for f in fits]), np.array([fit.two for fit in fits.values()])
    score, degrees = ring_score(held, two, *(np.array([far[f] for f in side]) for side in both.T))
    _, nearer = ring_score(held, two, *(np.array([near[f] for f in side]) for side in both.T))
    gain = sum(fit.one for fit in fits.values()) / max(float(two.sum()), 1e-300)
    return RingEvidence(score, float(gain), degrees, nearer)


def evidence_of_halves(
    shown: RingEvidence,
    above: Floats,
    fits: Mapping[int, HingedFit],
    steady: Mapping[int, float],
    turns: Mapping[int, tuple[Floats, Floats]],
) -> RingEvidence:
    """What a ring shows if its hinge must turn alike in both halves of what lies beyond it, not in neighbouring frames.

    For frames that are too far apart for a turn to go on from one to the next. Halves of one surface have its errors in common,
    so that this says less.

    shown : what the ring shows by neighbouring frames
    above, fits, steady : see `ring_evidence`
    turns : by frame, (3, 3) · (3, 3) the turn of the hinge by each half
    """
    first, second = (np.array(list(about_mean({f: turns[f][side] for f in fits}).values())) for side in (0, 1))
    held, two = np.array([steady[f] for f in fits]), np.array([fit.two for fit in fits.values()])
    score, far = ring_score(held, two, first, second)
    near = np.array(list(about_mean({f: above[f].T @ fit.pose.R for f, fit in fits.items()}).values()))
    return shown._replace(score=score, far=far, near=float(np.degrees(np.sqrt((near**2).sum(axis=1).mean()))))


def going_on(R: Floats, parents: Ints, pairs: Ints, least: float) -> float:
    """How much of the turn of a body's joints goes on from frame to frame: 1 for slow ones, 0 where frames are far apart.

    The median over the joints of the correlation of a turn with that in the next frame.

    R       : (frame, part, 3, 3) motions of the parts, from the reference
    parents : (part,) −1 for the root, which is the first
    pairs   : (pair, 2) frames that follow each other
    least   : root mean square turn of a joint that counts, at least, degrees
    returns : −1 to 1; 1 where no joint counts
    """
    frames, row = np.unique(pairs, return_inverse=True)
    alike = []
    for part in range(1, len(parents)):
        about = about_mean(dict(enumerate(R[frames, parents[part]].swapaxes(1, 2) @ R[frames, part])))
        w, v = np.array(list(about.values()))[row.reshape(pairs.shape).T]
        square = float((w**2 + v**2).sum(axis=1).mean()) / 2.0
        if square > np.radians(least) ** 2:
            alike.append(float((w * v).sum(axis=1).mean()) / square)
    return float(np.median(alike)) if alike else 1.0


def ring_score(steady: Floats, two: Floats, w: Floats, v: Floats) -> tuple[float, float]:
    """How clearly a hinge shows, and its root mean square turn as far as both of a pair agree, degrees.

    The score is by how much farther the part lies from the surfaces with the hinge held at its mean turn than with the hinge
    free, share of the latter, times the correlation of the hinge's turn with that of its pair (in the next frame: 1 for a slow
    turn, 0 for noise), less the standard error that noise about one axis has in so many pairs. Held and not straight: a
    reference whose shape is wrong beyond the ring is bent in all frames, but does not turn.

    steady, two : (frame,) mean squared distance with the hinge held, free
    w, v        : (pair, xyz) turns about their mean in two frames that follow each other, or by two halves in one, radian
    """
    agreeing = max(float((w * v).sum(axis=1).mean()), 0.0)
    alike = agreeing / max(float((w**2 + v**2).sum(axis=1).mean()) / 2.0, 1e-300)
    gain = np.sqrt(steady.sum() / max(two.sum(), 1e-300)) - 1.0
    return float(gain * max(alike - 1.0 / np.sqrt(len(w)), 0.0)), float(np.degrees(np.sqrt(agreeing)))


def judged_frames(count: int, takes: Sequence[slice] | None, most: int) -> tuple[Ints, Ints]:
    """Frames in which rings are judged, ascending · (pair, 2) which of them follow each other in one take.

    count : how many frames there are
    most  : how many of a take are all judged; if it has more, runs of `RUN` pairs
    """
    spans = [np.arange(count)[take] for take in takes or [slice(0, count)]]
    pairs = np.concatenate([_neighbours(span, most) for span in spans])
    return np.unique(pairs), pairs


def _neighbours(span: Ints, most: int) -> Ints:
    """(pair, 2) frames of a take that follow each other; of more than `most` frames as many as these have, in runs."""
    pairs = np.stack([span[:-1], span[1:]], axis=1)
    if len(span) > most and len(pairs) > RUN:
        begin = np.linspace(0, len(pairs) - RUN, -(-(most - 1) // RUN)).astype(np.int64)
        pairs = pairs[np.unique(begin[:, None] + np.arange(RUN))]
    return pairs


def about_mean(turn: dict[int, Floats]) -> dict[int, Floats]:
    """By frame, rotations (3, 3) against their mean as vectors (xyz,), radian."""
    Q = Rotation.from_matrix(list(turn.values()))
    return dict(zip(turn, (Q.mean().inv() * Q).as_rotvec(), strict=True))
