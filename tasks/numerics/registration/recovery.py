"""Frames in which tracking failed, tracked again: from the frame beyond, from the two before, and from alike ones (ours).

A chain of frames that lost a limb does not find it by going on; entered from its other end, it often does. The last frame of a
chain has no other end; but its neighbours have been fitted with all samples since, and predict it better than near poses did.
Frames in which the body holds its limbs alike know what none beside it does (`alike_poses`).
"""

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats
from kinetree.tasks.numerics.registration.alike_poses import AlikePosesSettings, alike_frames, entry, looked_through
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.registration.deformation import FitSettings, Pose, bending
from kinetree.tasks.numerics.registration.deformation_graph import DeformationGraph
from kinetree.tasks.numerics.registration.limb_swing import FrameLimbs, LimbSwingSettings
from kinetree.tasks.numerics.registration.near_pose import thinned_body
from kinetree.tasks.numerics.registration.take_entries import Limbs
from kinetree.tasks.numerics.registration.tracking import Tracking, TrackingSettings, tracking


class RecoverySettings(NamedTuple):
    """Which frames stand out by what they leave uncovered, and which new poses count."""

    deviations: float = 4.0
    """Median absolute deviations above the median of the sequence. Chosen on the recorded wolf."""
    margin: float = 0.004
    """Share of a frame above the median, where the deviations are smaller. Chosen on the recorded wolf."""
    clearly: float = LimbSwingSettings().clearly
    """How far a pose from an alike frame may bend that covers no more, share of how far the frame's own pose bends."""


class Tracked(NamedTuple):
    """Poses of all frames (frame,) and the share of each frame that its pose leaves uncovered (frame,)."""

    pose: Sequence[Pose]
    uncovered: Floats


class _Frames(NamedTuple):
    """How every frame is fitted: `graph`, `target` and `fitting` of `recovery`, and `Recovery.usual`."""

    graph: DeformationGraph
    target: Callable[[int], Target]
    fitting: FitSettings
    usual: float

    def tracked(self, at: int, before: Pose | None, start: Pose, limbs: FrameLimbs | None = None) -> Tracking:
        """The frame at a position, begun with the pose `start` of another one and, if it is known, of that before it."""
        return tracking(self.graph, before, start, self.target(at), self.fitting, usual=self.usual, limbs=limbs)


class Recovery(NamedTuple):
    """Which frames failed and which have a better pose.

    failed    : (frame,) frames that leave more uncovered than the others
    usual     : smallest share that any frame but the reference leaves uncovered; 1 where there is no other frame
    recovered : by position, the new poses of frames that are better with them
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
    seen: Sequence[Limbs] | None = None,
) -> Recovery:
    """Track failed frames again and keep what covers more (ours).

    Each from the frame beyond it, the outermost first; what still fails, from the two frames before it, outwards. Last, what
    still fails, and what bends farther than alike frames, from these: kept is what covers more, or as much and bends clearly
    less.

    graph     : of the reference mesh
    uncovered : (frame,) share of each frame that the tracked body leaves uncovered
    pose      : gives the tracked pose at a position; called only for frames beyond failed ones
    target    : gives the frame at a position; called only for failed ones
    reference : position of the reference frame, which never fails
    fitting   : how frames were tracked
    takes     : positions of the frames of each take, and of the one that is reached first; None takes all as one
    limbs     : gives the limbs of the body and of the frame at a position; None where they are not known
    seen      : (frame,) limbs of the frames; None where they are not known, and `pose` is called for all frames otherwise
    returns   : Recovery
    """
    others = np.arange(len(uncovered)) != reference
    failed = failures(uncovered, settings) & others
    frames = _Frames(graph, target, fitting, usual=float(uncovered[others].min(initial=1.0)))
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
        again = frames.tracked(at, before, here(beside), None if limbs is None else limbs(at))
        if again.uncovered < share(at):
            recovered[at] = again
    if seen is not None and len(graph.node):  # without nodes every vertex was followed, and nothing can be exchanged
        now = Tracked([here(at) for at in range(len(failed))], np.array([share(at) for at in range(len(failed))]))
        recovered |= _from_alike_frames(frames, now, reference, seen, settings or RecoverySettings())
    return Recovery(failed, frames.usual, recovered)


def _from_alike_frames(
    frames: _Frames, now: Tracked, reference: int, seen: Sequence[Limbs], settings: RecoverySettings
) -> dict[int, Tracking]:
    """By position, the frames that are better tracked from alike ones; the other arguments as `recovery` takes them."""
    graph, target = frames.graph, frames.target
    bends, failed = np.array([bending(graph, pose) for pose in now.pose]), failures(now.uncovered, settings)
    bends[reference] = np.inf  # it does not bend, and says nothing of others
    area, limits = graph.size**2, TrackingSettings()
    cloud, better = thinned_body(graph), dict[int, Tracking]()
    for at, others in looked_through(bends, alike_frames(seen), failed, AlikePosesSettings().strained * area):
        if at == reference:
            continue
        own, is_lost = now.pose[at], bool(failed[at])
        start = entry(cloud, own, target(at), seen, at, others, now.pose.__getitem__, failed=is_lost)
        if start is None:
            continue
        new = frames.tracked(at, None, start)
        bent, gain = bending(graph, new.pose), now.uncovered[at] - new.uncovered
        covers_more = gain > settings.margin and bent <= limits.bent * bends[at] + limits.bent_more * area
        if covers_more or (gain >= -settings.margin and bent <= settings.clearly * bends[at]):
            better[at] = new
    return better


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
