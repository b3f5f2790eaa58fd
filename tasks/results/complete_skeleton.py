"""The skeleton with poses for frames that are missing among the measured ones."""

from collections.abc import Iterable

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.results.complete_skeleton import CompleteSkeleton, CompleteSkeletonParams, Interpolated
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.numerics.input.frame_numbers import TAKE, take_spans
from kinetree.tasks.numerics.results import complete_skeleton as numerics


@task()
def complete_skeleton(skeleton: Skeleton, sequence: Sequence, params: CompleteSkeletonParams) -> CompleteSkeleton:
    """Interpolates the poses of frames that were dropped or are missing, and says which they are (ours)."""
    reasons = {bad.frame: bad.reason for bad in sequence.dropped}
    missing = [t for span in take_spans(skeleton.frames) for t in _missing(skeleton.frames[span], reasons, params.longest)]
    fields = {name: getattr(skeleton, name) for name in Skeleton.model_fields}
    if missing:
        poses = numerics.Poses(*(np.array(fields[name]) for name in numerics.Poses._fields))
        between = numerics.interpolated(skeleton.frames, missing, poses, np.array(skeleton.rest), skeleton.parents)
        order = np.argsort([*skeleton.frames, *missing])
        fields["frames"] = tuple(sorted((*skeleton.frames, *missing)))
        fields |= {name: np.concatenate([getattr(poses, name), getattr(between, name)])[order] for name in poses._fields}
    return CompleteSkeleton(
        **fields,
        takes=sequence.takes,
        interpolated=tuple(
            Interpolated(frame=t, cause="dropped" if t in reasons else "missing", reason=reasons.get(t, "")) for t in missing
        ),
    )


def _missing(frames: tuple[int, ...], dropped: Iterable[int], longest: int) -> list[int]:
    """The numbers that are missing in one take."""
    own = [t for t in dropped if t // TAKE == frames[0] // TAKE]
    return numerics.missing_frames(frames, own, longest)
