"""Following leaves through a sequence, so that each keeps its limb (2014, §5.1, Eq. 3).

`follow` is the default: it compares whole stems, from root to tip, and assigns all leaves of a frame together. Where tips
cross, roots do not, so stems need no prediction: a constant velocity, measured, made more swaps than it saved.
`follow_paper` is Eq. 3: mutual nearest neighbours of the tips whose normals agree, from the first frame on.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.optimize import linear_sum_assignment

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints

# Cost that forbids a pair; far above any sum of distances in units of the body's size.
_NEVER = 1e9


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
) -> Ints:
    """Tracks of leaves over all frames, by the least total distance between the stems of successive sights.

    A track never takes a leaf of another height of μ: when a hand rests on the hip, the elbow is not its tip. A lost
    track waits where it was and comes back only if it and the leaf fit each other clearly best; two limbs that were lost
    together and look alike come back as new tracks.

    stems    : per frame, (leaf, station, xyz) see `leaves.stems`, mesh unit
    value    : per frame, (leaf,) dimensionless μ at the tip, see `correlation.dimensionless`
    size     : (frame,) the body's size √A, mesh unit
    centre   : (frame, xyz) the surface's centre, mesh unit; stems are compared relative to it
    gate     : mean distance of the stations beyond which it is another limb, share of the size
    likeness : largest change of log μ at the tip between two sights
    margin   : for coming back, how many times farther every other lost track and free leaf must be
    returns  : (track, frame) row of the leaf in its frame, −1 where it is not seen; tracks in the order of first sight
    """
    shape = stems[0].shape[1:] if len(stems) else (1, 3)
    rows, last = np.zeros((0, len(stems)), dtype=np.int64), np.zeros((0, *shape))
    height, seen = np.zeros(0), np.zeros(0, dtype=np.int64)
    for t, S in enumerate(stems):
        here, log = (S - centre[t]) / size[t], np.log(value[t])
        away = np.linalg.norm(here[None] - last[:, None], axis=3).mean(axis=2)
        unlike = np.abs(log[None] - height[:, None])
        cost = np.where((away <= gate) & (unlike <= likeness), away, np.inf)
        track, leaf = _matched(cost, seen == t - 1, gate, margin)
        rows[track, t], last[track], height[track], seen[track] = leaf, here[leaf], log[leaf], t
        born = np.setdiff1d(np.arange(len(here)), leaf)
        entry = np.full((len(born), len(stems)), -1, dtype=np.int64)
        entry[:, t] = born
        rows, last = np.concatenate([rows, entry]), np.concatenate([last, here[born]])
        height, seen = np.concatenate([height, log[born]]), np.concatenate([seen, np.full(len(born), t)])
    return rows


def follow_paper(tips: Sequence[Floats], normals: Sequence[Floats]) -> Ints:
    """Tracks of the first frame's leaves by mutual nearest neighbours whose normals agree  (2014, Eq. 3).

    tips    : per frame, (leaf, xyz) mesh unit
    normals : per frame, (leaf, xyz) outward normals at the tips
    returns : (track, frame) row of the leaf in its frame, −1 from the frame on in which it has no match
    """
    first = len(tips[0]) if len(tips) else 0
    rows = np.full((first, len(tips)), -1, dtype=np.int64)
    rows[:, :1] = np.arange(first)[:, None]
    for t in range(1, len(tips)):
        if not len(tips[t - 1]) or not len(tips[t]):
            break
        distance = np.linalg.norm(tips[t - 1][:, None] - tips[t][None], axis=2)
        ahead, back = distance.argmin(axis=1), distance.argmin(axis=0)
        for k in range(first):
            i = rows[k, t - 1]
            if i >= 0 and back[ahead[i]] == i and normals[t - 1][i] @ normals[t][ahead[i]] > 0.0:
                rows[k, t] = ahead[i]
    return rows


def kept(tracks: Ints, begin: int, end: int, share: float = 0.5) -> Ints:
    """The fixed set of leaves of an interval: tracks seen in at least `share` of its frames.

    tracks     : (track, frame)
    begin, end : first and last frame position, both included
    share      : above 0 to 1; the paper keeps what is followed through the whole interval, 1
    returns    : (leaf,) rows of `tracks`, ascending; the same row in two intervals is the same limb
    """
    return np.flatnonzero((tracks[:, begin : end + 1] >= 0).mean(axis=1) >= share).astype(np.int64)


def gaps(tracks: Ints) -> list[Gap]:
    """What was lost, and when: every run of frames in which a track is not seen after its first sight.

    tracks  : (track, frame), each seen at least once
    returns : by track, then by frame
    """
    lost = []
    for k, row in enumerate(tracks):
        first = int(np.argmax(row >= 0))
        edges = first + np.flatnonzero(np.diff(np.concatenate([[False], row[first:] < 0, [False]])))
        lost += [Gap(k, int(a), int(b) - 1) for a, b in edges.reshape(-1, 2)]
    return lost


def bridged(tracks: Ints, stems: Sequence[Floats], longest: int = 3) -> tuple[Floats, Flags]:
    """Where every track's tip is, with short gaps filled on the straight line between the sights around them.

    tracks  : (track, frame)
    stems   : per frame, (leaf, station, xyz), the tip last
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


def _matched(cost: Floats, steady: Flags, gate: float, margin: float) -> tuple[Ints, Ints]:
    """Tracks and the leaves they take: first those seen in the frame before, then the lost ones, where it is safe.

    cost   : (track, leaf), infinite where a pair is out of the question
    steady : (track,) seen in the frame before
    """
    pairs: list[tuple[int, int]] = []
    leaf = np.arange(cost.shape[1])
    for track in (np.flatnonzero(steady), np.flatnonzero(~steady)):
        D = cost[np.ix_(track, leaf)]
        for a, b in _assigned(D, 2.0 * gate / 3.0):
            rival = min(np.delete(D[:, b], a).min(initial=np.inf), np.delete(D[a], b).min(initial=np.inf))
            if steady[track[a]] or rival >= margin * D[a, b]:
                pairs.append((int(track[a]), int(leaf[b])))
        leaf = np.setdiff1d(leaf, [b for _, b in pairs])
    found = np.array(pairs, dtype=np.int64).reshape(-1, 2)
    return found[:, 0], found[:, 1]


def _assigned(D: Floats, alone: float) -> list[tuple[int, int]]:
    """Pairs of the least total cost, where leaving a row or column without a partner costs `alone`.

    Without that price an assignment makes as many pairs as it can, and one lost limb would pull its neighbours along.
    """
    n, m = D.shape
    M = np.zeros((n + m, n + m))
    M[:n, :m] = np.where(np.isfinite(D), D, _NEVER)
    M[:n, m:] = np.where(np.eye(n, dtype=bool), alone, _NEVER)
    M[n:, :m] = np.where(np.eye(m, dtype=bool), alone, _NEVER)
    rows, columns = linear_sum_assignment(M)
    return [(int(a), int(b)) for a, b in zip(rows, columns, strict=True) if a < n and b < m and np.isfinite(D[a, b])]
