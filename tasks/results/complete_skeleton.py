"""The skeleton with poses for frames that are missing among the measured ones."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.results.complete_skeleton import CompleteSkeleton, CompleteSkeletonParams, Interpolated
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.numerics.results import complete_skeleton as numerics


@task()
def complete_skeleton(skeleton: Skeleton, sequence: Sequence, params: CompleteSkeletonParams) -> CompleteSkeleton:
    """Interpolates the poses of frames that were dropped or are missing, and says which they are (ours)."""
    reasons = {bad.frame: bad.reason for bad in sequence.dropped}
    missing = numerics.missing_frames(skeleton.frames, tuple(reasons), params.longest)
    fields = {name: getattr(skeleton, name) for name in Skeleton.model_fields}
    if missing:
        poses = numerics.Poses(*(np.array(fields[name]) for name in numerics.Poses._fields))
        between = numerics.interpolated(skeleton.frames, missing, poses, np.array(skeleton.rest), skeleton.parents)
        order = np.argsort([*skeleton.frames, *missing])
        fields["frames"] = tuple(sorted((*skeleton.frames, *missing)))
        fields |= {name: np.concatenate([getattr(poses, name), getattr(between, name)])[order] for name in poses._fields}
    return CompleteSkeleton(
        **fields,
        interpolated=tuple(
            Interpolated(frame=t, cause="dropped" if t in reasons else "missing", reason=reasons.get(t, "")) for t in missing
        ),
    )
