"""The order in which frames are reached from the reference: outwards, by steps as long as limbs allow (ours).

Where a body moves little from frame to frame a step goes over several of them, and the frames between are reached from a frame
beside them: the chain is shorter, and every frame starts from a pose that is as near as neighbours are where a body moves fast.

Frames that the body is learned from are reached from such frames alone, so that no other frame can change their poses. Each
other frame is reached from the frame beside it on the reference's side, whatever that is.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints


class TrackingOrderSettings(NamedTuple):
    """How long a step over several frames may be."""

    moved: float = 0.1
    """How far a point on a limb may move meanwhile, share of √area: the usual step of a recorded human and a wolf, which single
    frames are reached by. Not tuned."""
    frames: int = 6
    """Frames at most. Not varied."""


def limb_motion(stems: Floats, size: float, frames: int | None = None) -> Floats:
    """How far the limbs move from a frame to those after it: the most of any point on them (ours).

    stems   : (leaf, frame, station, xyz) points along the limbs, mesh unit; NaN where a leaf is not seen
    size    : √area of the body, mesh unit
    frames  : from how many frames on nobody asks; None takes that of `TrackingOrderSettings`
    returns : (step, frame) from each frame to the first, the second … after it, share of √area; infinite where they do not see
              the same limbs, or none
    """
    steps, count = frames or TrackingOrderSettings().frames, stems.shape[1]
    moved = np.full((steps, count), np.inf)
    seen: Flags = np.asarray(np.isfinite(stems).all(axis=(2, 3)))
    for step in range(1, min(steps, count - 1) + 1):
        away = np.linalg.norm(stems[:, step:] - stems[:, :-step], axis=3).max(axis=2, initial=0.0) / size
        is_alike = (seen[:, step:] == seen[:, :-step]).all(axis=0) & seen[:, step:].any(axis=0)
        most = np.where(seen[:, step:], away, 0.0).max(axis=0, initial=0.0)
        moved[step - 1, : count - step] = np.where(is_alike, most, np.inf)
    return moved


def takes_order(learned: Flags, takes: Sequence[slice], roots: Mapping[int, int], motion: Floats | None = None) -> Ints:
    """The position from which each frame is reached, in several takes.

    learned : (frame,) whether the body is learned from it
    takes   : positions of the frames of each take
    roots   : position of the frame of each take that is reached first, with that from which; −1 for the reference
    motion  : (step, learned frame) of `limb_motion`; None takes steps of one frame
    returns : (frame,)
    """
    before = np.empty(len(learned), dtype=np.int64)
    number: Ints = np.cumsum(learned) - learned
    for span in takes:
        root = next(t for t in roots if span.start <= t < span.stop)
        moved = None if motion is None else motion[:, number[span][learned[span]]]
        own = tracking_order(learned[span], root - span.start, moved)
        before[span] = np.where(own >= 0, own + span.start, roots[root])
    return before


def tracking_order(learned: Flags, reference: int, motion: Floats | None = None) -> Ints:
    """The position from which each frame is reached.

    learned   : (frame,) whether the body is learned from it
    reference : position of the reference, which is learned from
    motion    : (step, learned frame) of `limb_motion`; None takes steps of one frame
    returns   : (frame,) −1 for the reference
    """
    at = np.arange(len(learned))
    before = np.where(at == reference, -1, at + np.sign(reference - at))
    among = np.flatnonzero(learned)
    root = int(np.searchsorted(among, reference))
    moved = np.full((1, len(among)), np.inf) if motion is None else motion
    own = _fewest_steps(len(among), root, moved, TrackingOrderSettings().moved)
    before[among] = np.where(own >= 0, among[own], -1)
    return before


def _fewest_steps(count: int, root: int, motion: Floats, limit: float) -> Ints:
    """(frame,) from where each is reached in as few steps as may be, each outwards; of equal ways the shortest last step."""
    before, depth = np.full(count, -1), np.zeros(count, dtype=np.int64)
    for side in (1, -1):
        for t in range(root + side, count if side > 0 else -1, side):
            far = min(len(motion), abs(t - root))
            near = [t - side * k for k in range(1, far + 1) if k == 1 or motion[k - 1, min(t, t - side * k)] <= limit]
            before[t] = min(near, key=lambda s: (depth[s], abs(s - t)))
            depth[t] = depth[before[t]] + 1
    return before
