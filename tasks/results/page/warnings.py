"""What a person should know before relying on a result, in plain sentences."""

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.registration.frame_confidence import FrameConfidence
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.schemas.topology.intervals import Intervals
from kinetree.schemas.topology.leaves import Leaves
from kinetree.tasks.views.input import sequence_remarks
from kinetree.tasks.views.registration import frame_confidence_remarks
from kinetree.tasks.views.structure import skeleton_remarks
from kinetree.tasks.views.topology import leaf_losses


class WarningLimits(NamedTuple):
    """Beyond which a report warns; not recorded what they were chosen on."""

    short: int = 5
    """Frames below which a sequence, an interval or the support of a joint is short."""
    skin_distance: float = 0.015
    """Root mean square distance between the skin and the aligned meshes, share of the body's diagonal, above which the
    skeleton does not explain the motion."""
    confidence: float = 0.5
    """Mean confidence below which a joint is named."""
    named: int = 12
    """Most joints or frames that one sentence names."""


def warnings(
    skeleton: Skeleton,
    sequence: Sequence,
    intervals: Intervals,
    leaves: Leaves,
    frame_confidence: FrameConfidence,
    skin_distance: float,
    meshes: Mapping[int, Mesh],
) -> list[str]:
    """All warnings of a report, the most serious first; none where everything is well.

    skin_distance : between skin and aligned meshes, share of the body's diagonal
    meshes        : by source frame number
    """
    return [
        *_of_skeleton(skeleton, skin_distance),
        *sequence_remarks(sequence),
        *_of_frames(intervals, leaves, frame_confidence, meshes),
    ]


def counted(count: int, noun: str) -> str:
    """A number with its noun, such as 1 joint or 3 joints."""
    return f"{count} {noun}{'' if count == 1 else 's'}"


def _of_skeleton(skeleton: Skeleton, distance: float) -> Iterator[str]:
    """Warnings about the joints and the surface."""
    turning = [j for j, kind in enumerate(skeleton.kinds) if kind == "joint"]
    if not turning:
        yield from skeleton_remarks(skeleton)
    if len(skeleton.frames) < WarningLimits().short:
        yield f"only {counted(len(skeleton.frames), 'frame')}: joints are found by motion, more frames show more of them"
    if distance > WarningLimits().skin_distance:
        yield (
            f"the skeleton does not explain the motion: its skin is {100 * distance:.2g} % of the body's diagonal away from the"
            " aligned meshes; the body is not rigid there, or some of its joints are missing"
        )
    if (handles := _handles(skeleton)) > 0:
        yield (
            f"the surface has {counted(handles, 'handle')}, where limbs touch or the body forms a ring;"
            " a tree of joints cannot represent a closed loop"
        )
    weak = [skeleton.names[j] for j in turning if skeleton.support[j] < WarningLimits().short]
    if weak:
        yield f"supported by fewer than {WarningLimits().short} frames: {_named(weak, 'joint')}"
    low = [skeleton.names[j] for j in turning if float(skeleton.confidence[:, j].mean()) < WarningLimits().confidence]
    if low:
        yield f"low confidence: {_named(low, 'joint')}"


def _handles(skeleton: Skeleton) -> int:
    """Genus of the reference mesh where it is one closed surface, V − E + F = 2 − 2g; 0 where it is not."""
    F = np.asarray(skeleton.faces)
    sides = np.sort(np.concatenate([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]]), axis=1)
    edges, uses = np.unique(sides, axis=0, return_counts=True)
    return 0 if (uses != 2).any() else (2 - len(np.unique(F)) + len(edges) - len(F)) // 2


def _of_frames(
    intervals: Intervals, leaves: Leaves, frame_confidence: FrameConfidence, meshes: Mapping[int, Mesh]
) -> Iterator[str]:
    """Warnings about frames: alignment, leaves, intervals, removed components."""
    yield from frame_confidence_remarks(frame_confidence)
    yield from leaf_losses(leaves)
    for number, (begin, end) in enumerate(zip(intervals.begin, intervals.end, strict=True)):
        if end - begin + 1 < WarningLimits().short < len(intervals.frames):
            first = intervals.frames[int(begin)]
            yield f"interval {number} is short: {counted(end - begin + 1, 'frame')} from frame {first} on"
    removed = [str(frame) for frame, m in meshes.items() if m.cleaning.components > m.cleaning.components_kept]
    if removed:
        yield f"components apart from the body were removed in {_named(removed, 'frame')}"


def _named(names: list[str], noun: str) -> str:
    """The names after their noun; those beyond the limit are only counted."""
    more = f" and {len(names) - WarningLimits().named} more" if len(names) > WarningLimits().named else ""
    return f"{noun}{'s' if len(names) > 1 else ''} {', '.join(names[: WarningLimits().named])}{more}"
