"""The skeleton of every take by itself, as files have it (ours)."""

from typing import Any

import numpy as np

from kinetree.schemas.results.complete_skeleton import CompleteSkeleton
from kinetree.schemas.structure.error_bars import ErrorBars
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.numerics.input.frame_numbers import TAKE, take_spans

POSES = ("positions", "rotation", "confidence")


def of_takes(skeleton: Skeleton) -> dict[str, CompleteSkeleton]:
    """The skeleton with the frames of each take, by what follows "skeleton" in the names of its files.

    Joints, bones, rest pose and surface are those of all takes. Frames have their numbers within the take.
    """
    if not isinstance(skeleton, CompleteSkeleton):
        skeleton = CompleteSkeleton(**{name: getattr(skeleton, name) for name in Skeleton.model_fields}, interpolated=())
    if not skeleton.takes:
        return {"": skeleton}
    by_suffix = {}
    for span in take_spans(skeleton.frames):
        k = skeleton.frames[span.start] // TAKE
        poses: dict[str, Any] = {name: np.array(getattr(skeleton, name)[span]) for name in POSES}
        between = (t for t in skeleton.interpolated if t.frame // TAKE == k)
        own = tuple(t.model_copy(update={"frame": t.frame - k * TAKE}) for t in between)
        fields = {name: getattr(skeleton, name) for name in CompleteSkeleton.model_fields}
        frames = tuple(t - k * TAKE for t in skeleton.frames[span])
        poses |= {"frames": frames, "interpolated": own, "takes": ()}
        by_suffix[f"-{skeleton.takes[k]}"] = CompleteSkeleton(**{**fields, **poses})
    return by_suffix


def bars_of_takes(bars: ErrorBars, skeleton: Skeleton) -> dict[str, ErrorBars]:
    """The error bars with the frames of each take, by the same names as `of_takes`."""
    if not isinstance(skeleton, CompleteSkeleton) or not skeleton.takes or not bars.frames:
        return {"": bars}
    by_suffix = {}
    for span in take_spans(bars.frames):
        k = bars.frames[span.start] // TAKE
        own = {"frames": tuple(t - k * TAKE for t in bars.frames[span]), "in_frame": np.array(bars.in_frame[span])}
        by_suffix[f"-{skeleton.takes[k]}"] = bars.model_copy(update=own)
    return by_suffix
