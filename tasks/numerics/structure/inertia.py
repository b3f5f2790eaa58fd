"""Soft flesh stays behind its bone, so that a limb bends where it has no joint (ours, see `end_joints`).

A hand that swings bends by a few degrees in its middle, in every frame against its acceleration. That goes on from frame to
frame as the turn of a joint does; but inertia explains all of it, and of a joint's turn what is in step with its limb alone.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.structure.ring_evidence import FEWEST_PAIRS, agreeing_turn, agreement

MOST = 15.0
"""Root mean square turn that flesh has at most, degrees: what turns farther is a joint, though it dangles. Not varied: false
joints in hands have 2.2 to 6.0, one with 12,000 vertices 10 (person 711)."""

CLEAR = 0.25
"""Share of the square of all turning that inertia explains, from which on it counts in full; below, in proportion: where noise
turns a toe far, the little that agrees may be in step with the foot by chance. In hands it explains 0.25 to 0.89 of the turn of
false joints (eleven rings of ten people), of toes and fingers of a rigged body and of balls of feet that are hardly seen 0.00
to 0.17, of balls of people who run up to 0.66."""

Turns = dict[int, Floats]
"""By frame, (xyz,) a turn as a vector in the reference's axes."""


def inertial_turns(middle: Floats, along: Floats, R: Floats, t: Floats, takes: Sequence[slice] | None = None) -> Turns:
    """How soft flesh that stays behind would turn a hinge amid a piece, up to a factor; not in a take's first and last frame.

    Flesh answers the acceleration a of its bone by a shift against it, −a / (2πf)² at its own frequency f, most in the middle
    of the bone. So the piece bends about the axis across it and across a.

    middle  : (xyz,) of the piece in the reference, mesh unit
    along   : (xyz,) from its joint towards its end, any length
    R, t    : (frame, 3, 3) · (frame, xyz) the motion of the piece from the reference, mesh unit
    takes   : positions of the frames of each take, in order; None takes all as one
    returns : times along and a
    """
    turns: Turns = {}
    for take in takes or [slice(0, len(R))]:
        x = R[take] @ middle + t[take]
        a = np.einsum("fij,fi->fj", R[take][1:-1], x[:-2] - 2.0 * x[1:-1] + x[2:])
        turns |= dict(enumerate(np.cross(along, a), start=take.start + 1))
    return turns


def beyond_inertia(turn: Mapping[int, Floats], inertia: Mapping[int, Floats], pairs: Ints) -> float:
    """Share of the turn of a hinge that inertia does not explain, as far as it agrees from frame to frame.

    Where inertia explains little of all turning it counts in part (`CLEAR`). 1 in few frames, and where the hinge turns farther
    than flesh does (`MOST`).

    Flesh goes only so far: inertial turns q count as q / (1 + |q| / their root mean square).

    turn    : by frame, (xyz,) of the hinge against its mean, radian
    inertia : see `inertial_turns`
    pairs   : (pair, 2) frames that follow each other
    returns : 0 to 1
    """
    both = np.array([pair for pair in pairs.tolist() if all(f in turn and f in inertia for f in pair)], dtype=np.int64)
    if len(both) < FEWEST_PAIRS:
        return 1.0
    frames, row = np.unique(both, return_inverse=True)
    w, q = (np.array([by_frame[f] for f in frames.tolist()]) for by_frame in (turn, inertia))
    if agreeing_turn(*w[row.reshape(both.shape).T]) > MOST:
        return 1.0
    far, tiny = np.linalg.norm(q, axis=1, keepdims=True), float(np.finfo(float).tiny)
    q = q / (1.0 + far / max(float(np.sqrt((far**2).mean())), tiny))
    w, q = w - w.mean(axis=0), q - q.mean(axis=0)
    left = w - max(float((w * q).sum()), 0.0) / max(float((q**2).sum()), tiny) * q
    before, after = (agreement(both, *v[row.reshape(both.shape).T]) * float((v**2).sum()) for v in (w, left))
    if before <= 0.0:
        return 1.0
    explained = 1.0 - float((left**2).sum()) / float((w**2).sum())
    return 1.0 - min(explained / CLEAR, 1.0) * max(1.0 - after / before, 0.0)
