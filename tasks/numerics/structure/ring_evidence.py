"""What frames show of a hinge at a ring across the last part of a limb or the trunk (ours, see `end_joints`)."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.structure.hinged_piece import HingedFit

FEWEST_PAIRS = 3
"""Pairs of frames that follow each other, below which nothing is said of a ring, by halves neither."""

CHANCE = 1.6
"""Standard errors by which turns of noise in neighbouring frames agree about the axis about which they agree best, one time
in six at most; by halves, one in five."""

LEAST_SHARE = 0.01
"""Share of all turning that one axis has, below which its agreement counts less: rounding may agree about an axis that nothing
turns about."""

RUN = 3
"""Pairs of frames that follow each other without a gap, of takes with too many frames: 39 pairs are 52 frames then, and would
be 78 one by one."""


class RingEvidence(NamedTuple):
    """What a ring shows over some frames.

    score     : how much nearer the part lies with the hinge free than held at its mean turn, share, times how far the hinge's
                turns agree (`agreement`) in frames that follow each other, or in two halves of what lies beyond the ring. Held
                and not straight: a reference whose shape is wrong beyond the ring is bent in all frames, but does not turn
    gain      : how many times more is left of the part as one piece than with the hinge
    far, near : root mean square turn of the hinge, and of the nearer piece against the part above, as far as it agrees from
                frame to frame; by halves, of the hinge as far as these agree, of the nearer piece all of it; degrees
    """

    score: float
    gain: float
    far: float
    near: float

    def times(self, share: float) -> "RingEvidence":
        """The same with so much of the score."""
        return self._replace(score=share * self.score)


def ring_evidence(
    above: Floats, fits: Mapping[int, HingedFit], steady: Mapping[int, float], pairs: Ints, lasting: bool = True
) -> RingEvidence:
    """What a ring shows; nothing in few frames.

    above  : (frame, 3, 3) the motion of the part above, from the reference
    fits   : by frame, how the part lies
    steady : by frame, mean squared distance of the part with its hinge held, mesh unit²
    pairs  : (pair, 2) frames that follow each other
    lasting : whether the turn must go on to the frame after the next as well, as that of a body does in a dense take; the error
             of a fit goes on to the next frame alone, which begins where it ended
    """
    both = np.array([(a, b) for a, b in pairs.tolist() if a in fits and b in fits], dtype=np.int64)
    if len(both) < FEWEST_PAIRS:
        return RingEvidence(0.0, 0.0, 0.0, 0.0)
    far = about_mean({f: fit.pose.Q for f, fit in fits.items()})
    near = about_mean({f: above[f].T @ fit.pose.R for f, fit in fits.items()})
    held, two = np.array([steady[f] for f in fits]), np.array([fit.two for fit in fits.values()])
    which = (both, np.concatenate([both, next_but_one(both)])) if lasting else (both,)
    agrees = min(agreement(pair, *_turns(far, pair)) for pair in which)
    gain = sum(fit.one for fit in fits.values()) / max(float(two.sum()), 1e-300)
    degrees, nearer = (agreeing_turn(*_turns(turn, both)) for turn in (far, near))
    return RingEvidence(held_gain(held, two) * agrees, float(gain), degrees, nearer)


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
    own = np.repeat(np.array(list(fits), np.int64)[:, None], 2, axis=1)
    near = np.array(list(about_mean({f: above[f].T @ fit.pose.R for f, fit in fits.items()}).values()))
    return shown._replace(
        score=held_gain(held, two) * agreement(own, first, second),
        far=agreeing_turn(first, second),
        near=agreeing_turn(near, near),
    )


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


def held_gain(held: Floats, free: Floats) -> float:
    """How much farther a part lies from the surfaces with its hinge held than with the hinge free, share of the latter.

    held, free : (frame,) mean squared distance, mesh unit²
    """
    return max(float(np.sqrt(held.sum() / max(free.sum(), 1e-300))) - 1.0, 0.0)


def agreement(pairs: Ints, w: Floats, v: Floats) -> float:
    """How far the turns of pairs agree about one axis, beyond chance: 1 for slow turns of a hinge, 0 for noise.

    A small piece is held firmly by a surface about some axes and hardly about others, so that what turns about one axis is lost
    in noise about all three. The axis is that about which they agree best; noise would agree about its best axis too, by so
    many standard errors (`CHANCE`), which is taken off. No frame decides alone: that which agrees most with its partners does
    not count.

    pairs : (pair, 2) frames, or twice the same where a frame is told twice
    w, v  : (pair, xyz) their turns about their mean, radian
    """
    product = w.T @ v
    axis = np.linalg.eigh(product + product.T)[1][:, -1]
    p, q = w @ axis, v @ axis
    by_frame = np.bincount(pairs.ravel(), np.repeat(p * q, 2))
    counts = (pairs != int(np.argmax(by_frame))).all(axis=1)
    p, q = p[counts], q[counts]
    least = LEAST_SHARE * float((w**2).sum() + (v**2).sum())
    alike = 2.0 * float(p @ q) / max(float(p @ p + q @ q), least, 1e-300)
    return max(alike - CHANCE / float(np.sqrt(len(w))), 0.0)


def agreeing_turn(w: Floats, v: Floats) -> float:
    """Root mean square turn of pairs as far as they agree, about all axes about which they do, degrees.

    w, v : (pair, xyz) turns about their mean, radian
    """
    product = w.T @ v / len(w)
    agrees = np.linalg.eigvalsh((product + product.T) / 2.0)
    return float(np.degrees(np.sqrt(np.maximum(agrees, 0.0).sum())))


def next_but_one(pairs: Ints) -> Ints:
    """(pair, 2) of frames that follow each other (pair, 2), those with one between them."""
    after = dict(pairs.tolist())
    beyond = [(a, after[b]) for a, b in pairs.tolist() if b in after]
    return np.array(beyond, dtype=np.int64).reshape(-1, 2)


def _turns(turn: Mapping[int, Floats], pairs: Ints) -> tuple[Floats, Floats]:
    """(pair, xyz) · (pair, xyz) the turns of both frames of every pair."""
    first, second = (np.array([turn[f] for f in side]) for side in pairs.T.tolist())
    return first, second


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
