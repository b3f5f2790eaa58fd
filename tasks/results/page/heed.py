"""What a person should know before believing a report, in plain words."""

from collections.abc import Iterator, Mapping

import numpy as np

from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.schemas.topology.intervals import Intervals
from kinetree.schemas.topology.leaves import Leaves
from kinetree.tasks.numerics.results.scene import evenly_spread
from kinetree.tasks.results.formats.rig import skinned
from kinetree.tasks.views.structure import skeleton_remarks
from kinetree.tasks.views.topology import leaves_remarks

SHORT = 5
"""Frames below which an interval or a sequence is worth a warning."""
LOOSE = 0.015
"""How far the skin may be off the aligned meshes, share of the body's diagonal, until the skeleton fails to explain them."""
LOOKED_AT = 24
"""Frames in which the skin is compared with the aligned mesh."""


def heeded(
    skeleton: Skeleton,
    intervals: Intervals,
    leaves: Leaves,
    aligned: Mapping[int, Alignment],
    meshes: Mapping[int, Mesh],
) -> list[str]:
    """All that there is to heed, the gravest first; nothing where there is nothing."""
    return [*_of_skeleton(skeleton, aligned), *_of_frames(intervals, leaves, aligned, meshes)]


def off(skeleton: Skeleton, aligned: Mapping[int, Alignment]) -> float:
    """Root mean square distance between the skin and the aligned meshes of some frames, share of the body's diagonal."""
    size = float(np.linalg.norm(np.ptp(skeleton.vertices, axis=0)))
    shown = evenly_spread(len(skeleton.frames), LOOKED_AT)
    squared = [np.sum((skinned(skeleton, int(t)) - aligned[skeleton.frames[t]].vertices) ** 2, axis=1).mean() for t in shown]
    return float(np.sqrt(np.mean(squared))) / max(size, 1e-300)


def counted(count: int, what: str) -> str:
    """A number with its noun."""
    return f"{count} {what}{'' if count == 1 else 's'}"


def _of_skeleton(skeleton: Skeleton, aligned: Mapping[int, Alignment]) -> Iterator[str]:
    inner = [j for j, kind in enumerate(skeleton.kinds) if kind == "joint"]
    if not inner:
        yield from skeleton_remarks(skeleton)
    if len(skeleton.frames) < SHORT:
        yield f"{counted(len(skeleton.frames), 'frame')} only: joints are seen in motion, more frames show more of them"
    share = off(skeleton, aligned)
    if share > LOOSE:
        yield (
            f"the skeleton does not explain the motion: its skin is off the aligned meshes by {100 * share:.2g} % of the"
            " body's diagonal; the body is soft there, or too little of its motion is seen"
        )
    if (handles := _handles(skeleton)) > 0:
        yield (
            f"the surface has {counted(handles, 'handle')}, as a ring has or limbs that touch;"
            " a tree of joints cannot close them"
        )
    weak = [skeleton.names[j] for j in inner if skeleton.support[j] < SHORT]
    if weak:
        yield f"little support, seen in fewer than {SHORT} frames: {_some(weak, 'joint')}"
    low = [skeleton.names[j] for j in inner if float(skeleton.confidence[:, j].mean()) < 0.5]
    if low:
        yield f"low confidence: {_some(low, 'joint')}"


def _handles(skeleton: Skeleton) -> int:
    """Genus of the reference mesh where it is one closed surface, V − E + F = 2 − 2g; 0 where it is not."""
    F = np.asarray(skeleton.faces)
    sides = np.sort(np.concatenate([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]]), axis=1)
    edges, uses = np.unique(sides, axis=0, return_counts=True)
    return 0 if (uses != 2).any() else (2 - len(np.unique(F)) + len(edges) - len(F)) // 2


def _of_frames(
    intervals: Intervals, leaves: Leaves, aligned: Mapping[int, Alignment], meshes: Mapping[int, Mesh]
) -> Iterator[str]:
    doubted = [str(frame) for frame, a in aligned.items() if a.doubted > 0.5]
    if doubted:
        yield f"the alignment is not trusted in {_some(doubted, 'frame')}; poses there come from the whole model"
    yield from (text for text in leaves_remarks(leaves) if "not seen" in text or "no leaves" in text)
    for number, (begin, end) in enumerate(zip(intervals.begin, intervals.end, strict=True)):
        if end - begin + 1 < SHORT < len(intervals.frames):
            yield f"interval {number} is short: {counted(end - begin + 1, 'frame')} from frame {intervals.frames[int(begin)]}"
    removed = [str(frame) for frame, m in meshes.items() if m.cleaning.components > m.cleaning.components_kept]
    if removed:
        yield f"components that are not the body were removed in {_some(removed, 'frame')}"


def _some(names: list[str], what: str, most: int = 12) -> str:
    rest = f" and {len(names) - most} more" if len(names) > most else ""
    return f"{what}{'s' if len(names) > 1 else ''} {', '.join(names[:most])}{rest}"
