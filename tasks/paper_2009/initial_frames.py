"""From which frame each initial model is taken, and in which order it reaches the others."""

import numpy as np

from kinetree.errors import InputError
from kinetree.pipeline.task import task
from kinetree.schemas.paper_2009.coherent_intervals import CoherentIntervals
from kinetree.schemas.paper_2009.initial_frames import InitialFrames, InitialFramesParams
from kinetree.schemas.paper_2009.similarity import Similarity
from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.paper_2009 import initial_frames as numerics


@task()
def initial_frames(intervals: CoherentIntervals, similarity: Similarity, params: InitialFramesParams) -> InitialFrames:
    """Takes of each coherent interval the frame most similar to all its frames (2009, Sec. 2.3).

    raises : InputError if each interval has its own model and none is coherent
    """
    count = len(intervals.frames)
    spans = [np.arange(a, b + 1) for a, b in zip(intervals.begin.tolist(), intervals.end.tolist(), strict=True)]
    any_coherent = bool(spans)
    candidate = np.ones(count, np.bool_)
    if params.scope == "sequence":
        candidate = _candidates(intervals, spans)
        spans = [np.arange(count)]
    elif not spans:
        raise InputError(_nothing_coherent(intervals))
    S = np.array(similarity.similarity)
    structure, before, initial = np.full(count, -1), np.full(count, -1), []
    for number, span in enumerate(spans):
        start = _start(S[np.ix_(span, span)], candidate[span], intervals, span, params)
        reached = numerics.reached_from(S[np.ix_(span, span)], start, by_correlation=params.start == "correlation")
        structure[span] = number
        before[span] = np.where(reached >= 0, span[reached], -1)
        initial.append(int(span[start]))
    return InitialFrames(
        frames=intervals.frames, initial=np.array(initial), structure=structure, before=before, coherent=any_coherent
    )


def _start(similarity: Floats, candidate: Flags, intervals: CoherentIntervals, span: Ints, params: InitialFramesParams) -> int:
    """Position of the initial frame within its structure."""
    if params.initial == "similar":
        return numerics.initial_frame(similarity, candidate)
    return numerics.extended_frame(candidate, np.array(intervals.spread)[span], np.array(intervals.length)[span])


def _candidates(intervals: CoherentIntervals, spans: list[np.ndarray]) -> Flags:
    """(frame,) the frames of coherent intervals; without any, those with the most ends and the fewest loops."""
    if not spans:
        return numerics.most_open_frames(intervals.ends.astype(np.int64), intervals.loops.astype(np.int64))
    candidate = np.zeros(len(intervals.frames), np.bool_)
    candidate[np.concatenate(spans)] = True
    return candidate


def _nothing_coherent(intervals: CoherentIntervals) -> str:
    free = int((intervals.loops == 0).sum())
    fitting = int(((intervals.loops == 0) & (intervals.ends == intervals.wanted_ends)).sum())
    return (
        f"no topologically coherent interval: of {len(intervals.frames)} frames {free} have no loop, and {fitting} of these"
        f" have {intervals.wanted_ends} ends. Set initial_frames.scope=sequence, which needs none, or other"
        " coherent_intervals.ends and branches"
    )
