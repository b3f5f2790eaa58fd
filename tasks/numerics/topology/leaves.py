"""Leaves: extrema followed through a sequence, so that each keeps its limb (2014, Sec. 5.1, Eq. 3).

`follow` is the default: it compares whole stems, from the root of a limb to its end, and assigns all extrema of a frame
together. Where the ends of limbs cross, their roots do not, so stems need no prediction of motion.
`follow_paper` is Eq. 3: mutual nearest neighbours of the extrema whose normals agree, from the first frame on.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.optimize import linear_sum_assignment

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints

_FORBIDDEN = 1e9
"""Cost that forbids a pair; far above any sum of distances in units of the body's size."""


class LeavesSettings(NamedTuple):
    """How extrema are assigned to tracks."""

    unmatched: float = 2.0 / 3.0
    """Cost of leaving a track or an extremum without a partner, share of the gate. With more, one lost limb pulls the tracks of
    its neighbours along; with less, fast limbs are lost. Not varied so far."""


class Gap(NamedTuple):
    """A leaf that was not seen: frame positions `begin` to `end`, both included, of `track`."""

    track: int
    begin: int
    end: int


def follow(
    stems: Sequence[Floats],
    value: Sequence[Floats],
    size: Floats,
    centre: Floats,
    *,
    gate: float = 0.3,
    likeness: float = 0.2,
    margin: float = 1.5,
    settings: LeavesSettings | None = None,
) -> Ints:
    """Tracks of leaves over all frames, by the least total distance between stems from one frame to the next  (ours).

    A track never takes an extremum of another height of μ: when a hand rests on the hip, the elbow is not its end. A lost
    track waits where it was, and comes back only if it and the extremum fit each other clearly best. Two limbs that were
    lost together and look alike come back as new tracks.

    stems    : per frame, (extremum, station, xyz) see `extrema.stems`, mesh unit
    value    : per frame, (extremum,) dimensionless μ there, see `mu_histogram.dimensionless`
    size     : (frame,) the body's size √A, mesh unit
    centre   : (frame, xyz) the surface's centre, mesh unit; stems are compared relative to it
    gate     : mean distance of the stations beyond which it is another limb, share of the size
    likeness : largest change of log μ from one frame in which it is seen to the next
    margin   : for coming back, how many times farther every other lost track and free extremum must be
    returns  : (track, frame) row of the extremum in its frame, −1 where it is not seen; tracks in the order of first frames
    """
    alone = (settings or LeavesSettings()).unmatched * gate
    shape = stems[0].shape[1:] if len(stems) else (1, 3)
    rows, last = np.zeros((0, len(stems)), dtype=np.int64), np.zeros((0, *shape))
    height, last_seen = np.zeros(0), np.zeros(0, dtype=np.int64)
    for t, S in enumerate(stems):
        here, log = (S - centre[t]) / size[t], np.log(value[t])
        away = np.linalg.norm(here[None] - last[:, None], axis=3).mean(axis=2)
        unlike = np.abs(log[None] - height[:, None])
        cost = np.where((away <= gate) & (unlike <= likeness), away, np.inf)
        track, leaf = _matched(cost, last_seen == t - 1, alone, margin)
        rows[track, t], last[track], height[track], last_seen[track] = leaf, here[leaf], log[leaf], t
        born = np.setdiff1d(np.arange(len(here)), leaf)
        entry = np.full((len(born), len(stems)), -1, dtype=np.int64)
        entry[:, t] = born
        rows, last = np.concatenate([rows, entry]), np.concatenate([last, here[born]])
        height, last_seen = np.concatenate([height, log[born]]), np.concatenate([last_seen, np.full(len(born), t)])
    return rows


def follow_paper(ends: Sequence[Floats], normals: Sequence[Floats]) -> Ints:
    """Tracks of the first frame's extrema by mutual nearest neighbours whose normals agree  (2014, Eq. 3).

    ends    : per frame, (extremum, xyz) mesh unit
    normals : per frame, (extremum, xyz) outward normals there
    returns : (track, frame) row of the extremum in its frame, −1 from the frame on in which it has no match
    """
    first = len(ends[0]) if len(ends) else 0
    rows = np.full((first, len(ends)), -1, dtype=np.int64)
    rows[:, :1] = np.arange(first)[:, None]
    for t in range(1, len(ends)):
        if not len(ends[t - 1]) or not len(ends[t]):
            break
        distance = np.linalg.norm(ends[t - 1][:, None] - ends[t][None], axis=2)
        ahead, back = distance.argmin(axis=1), distance.argmin(axis=0)
        for k in range(first):
            i = rows[k, t - 1]
            if i >= 0 and back[ahead[i]] == i and normals[t - 1][i] @ normals[t][ahead[i]] > 0.0:
                rows[k, t] = ahead[i]
    return rows


def fixed_leaves(tracks: Ints, begin: int, end: int, share: float = 0.5) -> Ints:
    """The fixed set of leaves of an interval: tracks seen in at least `share` of its frames.

    tracks     : (track, frame)
    begin, end : first and last frame position, both included
    share      : above 0 to 1; the paper keeps what is followed through the whole interval, 1
    returns    : (leaf,) rows of `tracks`, ascending; the same row in two intervals is the same limb
    """
    return np.flatnonzero((tracks[:, begin : end + 1] >= 0).mean(axis=1) >= share).astype(np.int64)


def gaps(tracks: Ints) -> list[Gap]:
    """Every run of frames in which a track is not seen after its first frame.

    tracks  : (track, frame), each seen in one frame at least
    returns : by track, then by frame
    """
    lost = []
    for k, row in enumerate(tracks):
        first = int(np.argmax(row >= 0))
        edges = first + np.flatnonzero(np.diff(np.concatenate([[False], row[first:] < 0, [False]])))
        lost += [Gap(k, int(a), int(b) - 1) for a, b in edges.reshape(-1, 2)]
    return lost


def gaps_in(tracks: Ints, takes: Sequence[slice]) -> list[Gap]:
    """The same within takes: a track is of one take, and is not lost where that ends.

    takes : positions of the frames of each
    """
    within_takes = []
    for gap in gaps(tracks):
        first = int(np.argmax(tracks[gap.track] >= 0))
        last = next(span.stop for span in takes if span.start <= first < span.stop) - 1
        if gap.begin <= last:
            within_takes.append(gap._replace(end=min(gap.end, last)))
    return within_takes


def bridged(tracks: Ints, stems: Sequence[Floats], longest: int = 3) -> tuple[Floats, Flags]:
    """Where every leaf is, with short gaps filled on the straight line between the frames around them.

    tracks  : (track, frame)
    stems   : per frame, (extremum, station, xyz), the extremum last
    longest : frames of a gap that is filled; a limb may hide anywhere in a longer one
    returns : (track, frame, xyz) NaN where nothing is known, (track, frame) True where seen
    """
    X = np.full((*tracks.shape, 3), np.nan)
    for t, S in enumerate(stems):
        here = np.flatnonzero(tracks[:, t] >= 0)
        X[here, t] = S[tracks[here, t], -1]
    for gap in gaps(tracks):
        if gap.end - gap.begin < longest and gap.end + 1 < tracks.shape[1]:
            before, behind = X[gap.track, gap.begin - 1], X[gap.track, gap.end + 1]
            share = np.arange(1, gap.end - gap.begin + 2)[:, None] / (gap.end - gap.begin + 2)
            X[gap.track, gap.begin : gap.end + 1] = before + share * (behind - before)
    return X, tracks >= 0


def _matched(cost: Floats, steady: Flags, alone: float, margin: float) -> tuple[Ints, Ints]:
    """Tracks and the extrema they take: first those seen in the frame before, then the lost ones, where no other fits as well.

    cost   : (track, extremum), infinite where a pair is impossible
    steady : (track,) seen in the frame before
    alone  : see `_assigned`
    """
    pairs: list[tuple[int, int]] = []
    leaf = np.arange(cost.shape[1])
    for track in (np.flatnonzero(steady), np.flatnonzero(~steady)):
        D = cost[np.ix_(track, leaf)]
        for a, b in _assigned(D, alone):
            rival = min(np.delete(D[:, b], a).min(initial=np.inf), np.delete(D[a], b).min(initial=np.inf))
            if steady[track[a]] or rival >= margin * D[a, b]:
                pairs.append((int(track[a]), int(leaf[b])))
        leaf = np.setdiff1d(leaf, [b for _, b in pairs])
    rows = np.array(pairs, dtype=np.int64).reshape(-1, 2)
    return rows[:, 0], rows[:, 1]


def _assigned(D: Floats, alone: float) -> list[tuple[int, int]]:
    """Pairs of the least total cost, where leaving a row or column without a partner costs `alone`.

    Without that price an assignment makes as many pairs as it can, and one lost limb would pull its neighbours along.
    """
    n, m = D.shape
    M = np.zeros((n + m, n + m))
    M[:n, :m] = np.where(np.isfinite(D), D, _FORBIDDEN)
    M[:n, m:] = np.where(np.eye(n, dtype=bool), alone, _FORBIDDEN)
    M[n:, :m] = np.where(np.eye(m, dtype=bool), alone, _FORBIDDEN)
    rows, columns = linear_sum_assignment(M)
    return [(int(a), int(b)) for a, b in zip(rows, columns, strict=True) if a < n and b < m and np.isfinite(D[a, b])]
