"""The leaves of the body: extrema followed through the sequence."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from kinetree.pipeline.task import task
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.topology.extrema import Extrema
from kinetree.schemas.topology.intervals import Intervals
from kinetree.schemas.topology.leaves import Leaves, LeavesParams
from kinetree.tasks.numerics.input.frame_numbers import take_spans
from kinetree.tasks.numerics.topology.leaves import bridged, fixed_leaves, follow, follow_paper, gaps_in


@task(among=Sequence)
def leaves(extrema: Mapping[int, Extrema], intervals: Intervals, params: LeavesParams) -> Leaves:
    """Follows extrema from frame to frame and fixes the leaves of every interval (2014, Sec. 5.1, Eq. 3)."""
    frames = tuple(extrema.values())
    spans = [(int(a), int(b)) for a, b in zip(intervals.begin, intervals.end, strict=True)]
    takes = take_spans(tuple(extrema))
    rows = _across(frames, takes, params) if params.method == "stems" else _within(frames, spans)
    positions, _ = bridged(rows, [t.stems for t in frames], params.bridge)
    fixed = np.zeros((len(spans), len(rows)), dtype=np.bool_)
    for number, (begin, end) in enumerate(spans):
        fixed[number, fixed_leaves(rows, begin, end, params.share)] = True
    lost = np.array([tuple(gap) for gap in gaps_in(rows, takes)], dtype=np.int64).reshape(-1, 3)
    return Leaves(
        frames=tuple(extrema),
        rows=rows,
        positions=positions,
        kept=fixed,
        lost=lost[:, 0],
        lost_begin=lost[:, 1],
        lost_end=lost[:, 2],
    )


def _across(frames: tuple[Extrema, ...], takes: list[slice], params: LeavesParams) -> NDArray[np.int64]:
    """Tracks over a whole take: a limb that was lost at a contact comes back as itself. No track goes from take to take."""
    tracks = []
    for span in takes:
        here = frames[span]
        size, centre = np.array([t.size for t in here]), np.array([t.centre for t in here])
        stems, value = [t.stems for t in here], [t.value for t in here]
        tracked = follow(stems, value, size, centre, gate=params.gate, likeness=params.likeness, margin=params.margin)
        rows = np.full((len(tracked), len(frames)), -1, dtype=np.int64)
        rows[:, span] = tracked
        tracks.append(rows)
    return np.concatenate(tracks)


def _within(frames: tuple[Extrema, ...], spans: list[tuple[int, int]]) -> NDArray[np.int64]:
    """Tracks of each interval by itself, one below the other."""
    tracks = []
    for begin, end in spans:
        here = frames[begin : end + 1]
        tracked = follow_paper([t.stems[:, -1] for t in here], [t.normals for t in here])
        rows = np.full((len(tracked), len(frames)), -1, dtype=np.int64)
        rows[:, begin : end + 1] = tracked
        tracks.append(rows)
    return np.concatenate(tracks)
