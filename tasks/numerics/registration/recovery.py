"""Frames in which tracking failed, tracked again: from the frame beyond them, and predicted from the two before them (ours).

A chain of frames that lost a limb does not find it by going on; entered from its other end, it often does. The last frame of a
chain has no other end; but its neighbours have been fitted with all samples since, and predict it better than near poses did.
"""

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.registration.deformation import FitSettings, Pose
from kinetree.tasks.numerics.registration.deformation_graph import DeformationGraph
from kinetree.tasks.numerics.registration.limb_swing import FrameLimbs
from kinetree.tasks.numerics.registration.tracking import Tracking, tracking


class RecoverySettings(NamedTuple):
    """Which frames stand out by what they leave uncovered."""

    deviations: float = 4.0
    """Median absolute deviations above the median of the sequence. Chosen on the recorded wolf."""
    margin: float = 0.004
    """Share of a frame above the median, where the deviations are smaller. Chosen on the recorded wolf."""


class Recovery(NamedTuple):
    """Which frames failed and which have a better pose.

    failed    : (frame,) frames that leave more uncovered than the others
    usual     : smallest share that any frame but the reference leaves uncovered; 1 where there is no other frame
    recovered : by position, the new poses of frames that they cover better
    """

    failed: Flags
    usual: float
    recovered: dict[int, Tracking]


def recovery(
    graph: DeformationGraph,
    uncovered: Floats,
    pose: Callable[[int], Pose],
    target: Callable[[int], Target],
    reference: int,
    fitting: FitSettings,
    settings: RecoverySettings | None = None,
    takes: Sequence[tuple[slice, int]] | None = None,
    limbs: Callable[[int], FrameLimbs] | None = None,
) -> Recovery:
    """Track failed frames again and keep what covers more (ours).

    Each from the frame beyond it, the outermost first; what still fails, from the two frames before it, outwards.

    graph     : of the reference mesh
    uncovered : (frame,) share of each frame that the tracked body leaves uncovered
    pose      : gives the tracked pose at a position; called only for frames beyond failed ones
    target    : gives the frame at a position; called only for failed ones
    reference : position of the reference frame, which never fails
    fitting   : how frames were tracked
    takes     : positions of the frames of each take, and of the one that is reached first; None takes all as one
    limbs     : gives the limbs of the body and of the frame at a position; None where they are not known
    returns   : Recovery
    """
    others = np.arange(len(uncovered)) != reference
    failed = failures(uncovered, settings) & others
    usual = float(uncovered[others].min(initial=1.0))
    recovered: dict[int, Tracking] = {}
    spans = takes or [(slice(0, len(failed)), reference)]
    ways = [*((at, beyond, None) for at, beyond in _inwards(failed, spans)), *_outwards(failed, spans)]

    def here(at: int) -> Pose:
        return recovered[at].pose if at in recovered else pose(at)

    def share(at: int) -> float:
        return recovered[at].uncovered if at in recovered else float(uncovered[at])

    for at, beside, earlier in ways:
        if share(beside) >= share(at) or (earlier is not None and not _still_fails(at, share(at), uncovered, settings)):
            continue
        before = None if earlier is None else here(earlier)
        own = None if limbs is None else limbs(at)
        again = tracking(graph, before, here(beside), target(at), fitting, usual=usual, limbs=own)
        if again.uncovered < share(at):
            recovered[at] = again
    return Recovery(failed, usual, recovered)


def failures(uncovered: Floats, settings: RecoverySettings | None = None, usual: Flags | None = None) -> Flags:
    """Frames that stand out: u > median + max(4 MAD, margin) (ours).

    uncovered : (frame,) share of each frame that the body leaves uncovered
    usual     : (frame,) the frames whose median and deviation count; None takes all
    returns   : (frame,)
    """
    settings = settings or RecoverySettings()
    among = uncovered if usual is None else uncovered[usual]
    median = float(np.median(among))
    deviation = float(np.median(np.abs(among - median)))
    return uncovered > max(median + settings.deviations * deviation, median + settings.margin)


def _inwards(failed: Flags, takes: Sequence[tuple[slice, int]]) -> Iterator[tuple[int, int]]:
    """(failed frame, frame beyond it) from both ends of every take towards its frame that is reached first."""
    for span, first in takes:
        yield from ((at, at - 1) for at in range(span.start + 1, first) if failed[at])
        yield from ((at, at + 1) for at in range(span.stop - 2, first, -1) if failed[at])


def _outwards(failed: Flags, takes: Sequence[tuple[slice, int]]) -> Iterator[tuple[int, int, int]]:
    """(failed frame, the frame before it, the one before that) from the frame of every take that is reached first outwards."""
    for span, first in takes:
        yield from ((at, at - 1, at - 2) for at in range(first + 2, span.stop) if failed[at])
        yield from ((at, at + 1, at + 2) for at in range(first - 2, span.start - 1, -1) if failed[at])


def _still_fails(at: int, share: float, uncovered: Floats, settings: RecoverySettings | None) -> bool:
    """Whether a frame would stand out with this share uncovered."""
    now = uncovered.copy()
    now[at] = share
    return bool(failures(now, settings)[at])
