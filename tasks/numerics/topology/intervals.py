"""Cutting a sequence where the body's topology changes: drops of the correlation, and cues beside it (2014, Sec. 4).

The paper cuts at sharp drops of C(t) and gives no threshold; `fixed_intervals` takes one. `intervals` derives it from the
series itself and adds cues: quantities that motion hardly changes as long as nothing touches. Each cue is judged alone, a
change counts only if it lasts, and the result says which cues made which cut.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.topology.correlation import correlations

CORRELATION = "correlation"
TAKE = "take"
"""What cuts where one take ends and the next begins."""


class IntervalsSettings(NamedTuple):
    """How a lasting change is told from noise."""

    least_change: float = 1e-3
    """1 − C below this counts as this much: two reconstructions of a body at rest differ by it."""
    least_spread: float = 0.5
    """Spread of log(1 − C) below which it counts as this much: in a clip almost at rest too little moves to measure one.
    Not varied so far."""
    window: int = 3
    """Frames on either side of a transition whose median a step is measured between, so that one odd frame does not count."""
    lasting: float = 0.5
    """Share of a drop by which the frames before and behind it must still differ; a frame that returns is noise."""


class Cue(NamedTuple):
    """What stays the same while nothing touches.

    profile : (frame, rank) the quantity, such as the persistences of the extrema, highest first, padded with zeros
    least   : a step of any rank by this much counts, see `steps`
    """

    profile: Floats
    least: float


@dataclass(frozen=True)
class Intervals:
    """A partition of the frames into runs in which the topology stays.

    begin, end : (interval,) first and last frame position of each, both included; end[i] + 1 = begin[i + 1]
    z          : (transition,) z score of log(1 − C) between frames t and t + 1; empty for one frame
    cues       : per cut, the names of the cues that made it; cut i lies between end[i] and begin[i + 1]
    """

    begin: Ints
    end: Ints
    z: Floats
    cues: tuple[tuple[str, ...], ...]


def stacked(rows: Sequence[Floats]) -> Floats:
    """Profiles of different lengths as one array, padded with zeros.

    rows    : per frame, (rank,) values, highest first
    returns : (frame, rank), at least one rank
    """
    profile = np.zeros((len(rows), max([1, *(len(row) for row in rows)])))
    for t, row in enumerate(rows):
        profile[t, : len(row)] = row
    return profile


def intervals(
    H: Floats,
    cues: Mapping[str, Cue],
    *,
    high: float = 2.0,
    low: float = 1.5,
    drop: float = 0.02,
    minimum: int = 3,
    correlation: bool = True,
    settings: IntervalsSettings | None = None,
) -> Intervals:
    """Cut where the correlation drops for good or a cue steps for good.

    H           : (frame, bin) histograms of dimensionless μ over one range
    cues        : by name; none uses the correlation alone
    high, low   : a drop of the correlation begins above z = high and reaches as far as z stays above low
    drop        : and somewhere in it 1 − C must exceed this
    minimum     : frames an interval has at least; cuts nearer to each other are one, cuts nearer to the ends none
    correlation : False cuts by the cues alone
    returns     : Intervals covering every frame; one if there is one frame or nothing changes
    """
    chosen = settings or IntervalsSettings()
    z = z_scores(correlations(H), chosen)
    causes: dict[int, list[str]] = {}
    if correlation:
        for t in np.flatnonzero(drops(H, z, high, low, drop, chosen)):
            causes.setdefault(int(t), []).append(CORRELATION)
    for name, cue in cues.items():
        for t in np.flatnonzero(steps(cue.profile, cue.least, chosen)):
            causes.setdefault(int(t), []).append(name)
    return _partition(len(H), z, causes, minimum)


def fixed_intervals(C: Floats, threshold: float, minimum: int = 1) -> Intervals:
    """Cut wherever C(t) < threshold: the paper's rule (2014, Sec. 4).

    C         : (transition,) correlation of successive histograms
    threshold : −1 … 1; the paper gives no number
    minimum   : as in `intervals`
    returns   : Intervals of len(C) + 1 frames
    """
    causes = {int(t): [CORRELATION] for t in np.flatnonzero(threshold > C)}
    return _partition(len(C) + 1, z_scores(C), causes, minimum)


def joined(parts: Sequence[Intervals]) -> Intervals:
    """The intervals of several takes, one after the other, with a cut wherever a take begins.

    parts : of each take by itself; its z score is 0 at the cuts between takes
    """
    if len(parts) == 1:
        return parts[0]
    first = np.cumsum([0, *(part.end[-1] + 1 for part in parts)])
    z = [row for part in parts for row in (np.zeros(1), part.z)][1:]
    cues = [row for part in parts for row in (((TAKE,),), part.cues)][1:]
    begin, end = (
        np.concatenate([getattr(part, name) + at for part, at in zip(parts, first, strict=False)]) for name in ("begin", "end")
    )
    return Intervals(begin, end, np.concatenate(z), tuple(cue for row in cues for cue in row))


def z_scores(C: Floats, settings: IntervalsSettings | None = None) -> Floats:
    """How far each transition stands out: (log(1 − C) − median) / (1.4826 · median absolute deviation).

    Both 1 − C and the spread have a floor, so that equal frames and clips almost at rest have scores, near 0.

    C       : (transition,) correlation of successive histograms
    returns : (transition,)
    """
    chosen = settings or IntervalsSettings()
    if not len(C):
        return np.zeros(0)
    change = np.log(np.maximum(1.0 - C, chosen.least_change))
    middle = np.median(change)
    spread = 1.4826 * float(np.median(np.abs(change - middle)))
    return np.asarray((change - middle) / max(spread, chosen.least_spread))


def drops(H: Floats, z: Floats, high: float, low: float, drop: float, settings: IntervalsSettings | None = None) -> Flags:
    """Transitions at which the histogram changes and stays changed, one for each run of z above `low`.

    A run counts if z > high and 1 − C > drop at its largest step, and if the frames before it and those behind it, next
    or next but one, all differ by at least half of that step: a frame that returns is noise.

    H         : (frame, bin)
    z         : (transition,) see `z_scores`
    high, low, drop : as in `intervals`
    returns   : (transition,) True at the largest step of each run that counts
    """
    lasting = (settings or IntervalsSettings()).lasting
    cuts = np.zeros(len(z), dtype=np.bool_)
    change = 1.0 - correlations(H)
    for a, b in _runs(z > low):
        top = a + int(np.argmax(change[a:b]))
        if z[top] > high and change[top] > drop:
            before, behind = H[max(a - 1, 0) : a + 1], H[b : b + 2]
            stays = min(1.0 - correlations(np.stack([x, y]))[0] for x in before for y in behind)
            cuts[top] = stays >= lasting * change[top]
    return cuts


def steps(profile: Floats, least: float, settings: IntervalsSettings | None = None) -> Flags:
    """Transitions at which a profile steps and does not return, one for each run of transitions that shows the step  (ours).

    A lasting change shows in the medians of a few frames on either side, a sharp one between the two frames next to the
    transition; the mean of both must reach `least`. Motion is not sharp, noise does not last.

    profile : (frame, rank); values sorted within a frame need no matching, since sorting never widens a difference
    least   : in the profile's unit
    returns : (transition,) True at the sharpest transition of each run
    """
    window = (settings or IntervalsSettings()).window
    cuts = np.zeros(max(len(profile) - 1, 0), dtype=np.bool_)
    sharp = sharpness(profile)
    lasting = np.zeros(len(cuts))
    for t in range(len(cuts)):
        before = np.median(profile[max(t + 1 - window, 0) : t + 1], axis=0)
        lasting[t] = np.abs(np.median(profile[t + 1 : t + 1 + window], axis=0) - before).max(initial=0.0)
    for a, b in _runs(lasting >= least):
        top = a + int(np.argmax(sharp[a:b]))
        cuts[top] = 0.5 * (sharp[top] + lasting[top]) >= least
    return cuts


def sharpness(profile: Floats) -> Floats:
    """How far a profile moves at each transition: the largest change of any rank.

    profile : (frame, rank) as for `steps`
    returns : (transition,) in the profile's unit
    """
    return np.abs(np.diff(profile, axis=0)).max(axis=1, initial=0.0)


def _runs(flags: Flags) -> Ints:
    """(run, 2) first position of each run of True, and the position behind it."""
    return np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]))).reshape(-1, 2).astype(np.int64)


def _partition(frames: int, z: Floats, causes: Mapping[int, list[str]], minimum: int) -> Intervals:
    """Cuts nearer than `minimum` to each other are one: where most cues agree, then at the largest z, then the first."""
    groups: list[list[int]] = []
    for t in sorted(t for t in causes if minimum <= t + 1 <= frames - minimum):
        if groups and t - groups[-1][0] < minimum:
            groups[-1].append(t)
        else:
            groups.append([t])
    cuts: list[int] = []
    cues: list[tuple[str, ...]] = []
    for group in groups:
        behind = cuts[-1] if cuts else -1
        cut = max((t for t in group if t - behind >= minimum), key=lambda t: (len(causes[t]), z[t], -t), default=None)
        if cut is not None:
            cuts.append(cut)
            cues.append(tuple(dict.fromkeys(name for t in group for name in causes[t])))
    ends = np.array([*cuts, frames - 1], dtype=np.int64)
    return Intervals(np.concatenate([[0], ends[:-1] + 1]).astype(np.int64), ends, z, tuple(cues))
