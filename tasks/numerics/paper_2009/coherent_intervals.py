"""Topologically coherent intervals: runs of frames whose graphs have the body's own topology (2009, Sec. 2.2)."""

from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Ints

Degrees = tuple[int, ...]
LEAST_SHARE = 0.25
"""Branch degrees that occur so often, against the most frequent ones, are the body's too: a joint of four branches is drawn as
two of three in some frames (condition ii). Not varied so far."""


class CoherentIntervals(NamedTuple):
    """Which frames are coherent, and the runs of those.

    coherent   : (frame,)
    begin, end : (interval,) first and last position of every run that is long enough, both included
    ends       : the number of ends that a coherent graph has
    branches   : the branch degrees that it may have
    """

    coherent: Flags
    begin: Ints
    end: Ints
    ends: int
    branches: tuple[Degrees, ...]


def coherent_intervals(
    count: Ints,
    loops: Ints,
    degrees: Sequence[Degrees],
    *,
    ends: int | None = None,
    branches: Sequence[Degrees] | None = None,
    minimum: int = 3,
) -> CoherentIntervals:
    """Runs of frames without a loop, with the prevailing number of ends (i) and its branch points (ii).

    count, loops : (frame,) ends of each graph · loops that stay after simplification
    degrees      : of each frame, the numbers of edges at its branch points, descending
    ends         : of condition (i); None takes the number that prevails among frames without a loop
    branches     : of condition (ii); None takes those that prevail among frames that fulfil the rest
    minimum      : frames of a run
    """
    free = np.asarray(loops == 0)
    prevailing = ends if ends is not None else _most_frequent(count[free] if free.any() else count)
    fitting = free & (count == prevailing)
    tally = Counter(d for d, fits in zip(degrees, fitting, strict=True) if fits)
    most = max(tally.values(), default=0)
    allowed = tuple(branches) if branches is not None else tuple(sorted(d for d, n in tally.items() if n >= LEAST_SHARE * most))
    coherent = fitting & np.array([d in allowed for d in degrees], dtype=np.bool_)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], coherent, [False]]))).reshape(-1, 2)
    runs = edges[edges[:, 1] - edges[:, 0] >= minimum]
    return CoherentIntervals(coherent, runs[:, 0], runs[:, 1] - 1, prevailing, allowed)


def _most_frequent(values: Ints) -> int:
    """The most frequent value, the greatest of several."""
    distinct, times = np.unique(values, return_counts=True)
    return int(distinct[times == times.max()].max()) if len(distinct) else 0
