"""The leaves of the body: tips followed through the sequence."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from kinetree.pipeline.task import task
from kinetree.schemas.topology.extrema import Extrema
from kinetree.schemas.topology.intervals import Intervals
from kinetree.schemas.topology.leaves import Leaves, LeavesParams
from kinetree.tasks.numerics.topology.leaves import bridged, follow, follow_paper, gaps, kept


@task()
def leaves(tips: Mapping[int, Extrema], intervals: Intervals, params: LeavesParams) -> Leaves:
    """Follows tips from frame to frame and fixes the leaves of every interval (2014, Sec. 5.1, Eq. 3)."""
    seen = tuple(tips.values())
    spans = [(int(a), int(b)) for a, b in zip(intervals.begin, intervals.end, strict=True)]
    rows = _across(seen, params) if params.method == "stems" else _within(seen, spans)
    positions, _ = bridged(rows, [t.stems for t in seen], params.bridge)
    fixed = np.zeros((len(spans), len(rows)), dtype=np.bool_)
    for number, (begin, end) in enumerate(spans):
        fixed[number, kept(rows, begin, end, params.share)] = True
    lost = np.array([tuple(gap) for gap in gaps(rows)], dtype=np.int64).reshape(-1, 3)
    return Leaves(
        frames=tuple(tips),
        rows=rows,
        positions=positions,
        kept=fixed,
        lost=lost[:, 0],
        lost_begin=lost[:, 1],
        lost_end=lost[:, 2],
    )


def _across(seen: tuple[Extrema, ...], params: LeavesParams) -> NDArray[np.int64]:
    """Tracks over the whole sequence: a limb that was lost at a contact comes back as itself."""
    size, centre = np.array([t.size for t in seen]), np.array([t.centre for t in seen])
    stems, value = [t.stems for t in seen], [t.value for t in seen]
    return follow(stems, value, size, centre, gate=params.gate, likeness=params.likeness, margin=params.margin)


def _within(seen: tuple[Extrema, ...], spans: list[tuple[int, int]]) -> NDArray[np.int64]:
    """Tracks of each interval by itself, one below the other."""
    tracks = []
    for begin, end in spans:
        here = seen[begin : end + 1]
        found = follow_paper([t.stems[:, -1] for t in here], [t.normals for t in here])
        rows = np.full((len(found), len(seen)), -1, dtype=np.int64)
        rows[:, begin : end + 1] = found
        tracks.append(rows)
    return np.concatenate(tracks)
