"""What a person should know before relying on a result: the verdict's findings, and what else was noticed."""

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.registration.frame_confidence import FrameConfidence
from kinetree.schemas.results.verdict import Finding, Verdict
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.schemas.topology.intervals import Intervals
from kinetree.schemas.topology.leaves import Leaves
from kinetree.tasks.results.page.document import Remark
from kinetree.tasks.views.input import sequence_remarks
from kinetree.tasks.views.registration import frame_confidence_remarks
from kinetree.tasks.views.topology import leaf_losses
from kinetree.tasks.views.verdict import NAMED, runs, sentence


class WarningLimits(NamedTuple):
    """Beyond which a report says something; not recorded what they were chosen on."""

    short: int = 5
    """Frames below which an interval is short."""
    confidence: float = 0.5
    """Mean confidence from which on a joint's interval is listed."""


def faults(verdict: Verdict) -> list[Remark]:
    """What the verdict rests on, the most serious first; each leads to its first frame and joint."""
    return [_remark(f, verdict) for f in verdict.findings if f.severity != "note"]


def notes(
    verdict: Verdict,
    skeleton: Skeleton,
    sequence: Sequence,
    intervals: Intervals,
    leaves: Leaves,
    frame_confidence: FrameConfidence,
    meshes: Mapping[int, Mesh],
) -> list[Remark]:
    """What does not change the verdict; equal kinds are one note.

    meshes : by source frame number
    """
    return [
        *(_remark(f, verdict) for f in verdict.findings if f.severity == "note"),
        *(Remark(text) for text in sequence_remarks(sequence)),
        *_of_surface(skeleton),
        *_of_frames(intervals, leaves, frame_confidence, meshes),
    ]


def counted(count: int, noun: str) -> str:
    """A number with its noun, such as 1 joint or 3 joints."""
    return f"{count} {noun}{'' if count == 1 else 's'}"


def _of_surface(skeleton: Skeleton) -> Iterator[Remark]:
    """That the surface closes a loop."""
    if (handles := _handles(skeleton)) > 0:
        yield Remark(
            f"the surface has {counted(handles, 'handle')}, where limbs touch or the body forms a ring;"
            " a tree of joints cannot represent a closed loop"
        )


def _handles(skeleton: Skeleton) -> int:
    """Genus of the reference mesh where it is one closed surface, V − E + F = 2 − 2g; 0 where it is not."""
    F = np.asarray(skeleton.faces)
    sides = np.sort(np.concatenate([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]]), axis=1)
    edges, uses = np.unique(sides, axis=0, return_counts=True)
    return 0 if (uses != 2).any() else (2 - len(np.unique(F)) + len(edges) - len(F)) // 2


def _of_frames(
    intervals: Intervals, leaves: Leaves, frame_confidence: FrameConfidence, meshes: Mapping[int, Mesh]
) -> Iterator[Remark]:
    """Notes about frames: alignment, leaves, intervals, removed components."""
    inlier = np.asarray(frame_confidence.inlier)
    partly = np.where(inlier, frame_confidence.unreliable, 0.0)
    others = frame_confidence.model_copy(update={"inlier": np.ones_like(inlier), "unreliable": partly})
    for text in frame_confidence_remarks(others):
        yield Remark(text, frame_confidence.frames[int(np.argmax(partly))])
    lost = leaf_losses(leaves)
    if len(lost) > 1:
        yield Remark(f"{len(lost)} leaves were lost for a time: {'; '.join(lost)}", leaves.frames[int(min(leaves.lost_begin))])
    else:
        yield from (Remark(text) for text in lost)
    short = [
        intervals.frames[int(begin)]
        for begin, end in zip(intervals.begin, intervals.end, strict=True)
        if end - begin + 1 < WarningLimits().short < len(intervals.frames)
    ]
    if short:
        begins = ", ".join(map(str, short[:NAMED])) + (f" and {len(short) - NAMED} more" if len(short) > NAMED else "")
        text = f"{counted(len(short), 'short interval')}, of fewer than {WarningLimits().short} frames: from frame {begins} on"
        yield Remark(text, short[0])
    removed = [frame for frame, m in meshes.items() if m.cleaning.components > m.cleaning.components_kept]
    if removed:
        yield Remark(f"components apart from the body were removed in {runs(removed, tuple(meshes))}", removed[0])


def _remark(finding: Finding, verdict: Verdict) -> Remark:
    """A finding in words, with the frame and the joint to look at."""
    frame = finding.frames[0] if finding.frames else None
    return Remark(sentence(finding, verdict), frame, verdict.joints.index(finding.joints[0]) if finding.joints else None)
