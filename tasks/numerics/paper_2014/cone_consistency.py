"""Cones matched across intervals, erroneous ones rejected, lost ones recovered (2014, Sec. 6.1.1.2 to 6.1.1.4, Eqs. 7, 8)."""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints


class ConeConsistencySettings(NamedTuple):
    """When two cones are one (ours)."""

    least_overlap: float = 0.5
    """Share of the smaller of two cones that must lie in the other, transferred over a cut, for both to be the same cone.
    Chosen as more than half; sensitivity not recorded. At 1 a cone that grew differently becomes a second cone, at 0 cones
    that touch become one."""


class IntervalCones(NamedTuple):
    """The cones of one interval.

    annulus  : (leaf, vertex) annulus of every vertex, −1 beyond the cone
    area     : (vertex,) mesh unit²
    mu_range : (leaf,) range of μ in the cone
    """

    annulus: Ints
    area: Floats
    mu_range: Floats

    def rank(self, leaf: int) -> tuple[int, float]:
        """How long a bone the cone can hold: its number of annuli, then the range of μ (Sec. 6.1.1.3)."""
        return int(self.annulus[leaf].max(initial=-1)), float(self.mu_range[leaf])


class Cut(NamedTuple):
    """Correspondences between two successive intervals at the cut between them.

    to_next, to_previous   : (vertex,) vertex of the next interval's reference at each of the previous one's · the reverse;
                             −1 for none
    leaf_before, leaf_after : (pair,) leaves of the previous and of the next interval that are mutually nearest
    leaf_distance          : (pair,) how far apart they are, mesh unit
    """

    to_next: Ints
    to_previous: Ints
    leaf_before: Ints
    leaf_after: Ints
    leaf_distance: Floats


class ConsistentCones(NamedTuple):
    """One set of cones for the whole sequence.

    annulus : of each interval, (cone, vertex) annulus of every vertex, −1 beyond the cone
    leaf    : (interval, cone) the cone's leaf in the interval, −1 where the cone was recovered
    """

    annulus: tuple[Ints, ...]
    leaf: Ints


def consistent_cones(
    intervals: list[IntervalCones], cuts: list[Cut], threshold: float, settings: ConeConsistencySettings | None = None
) -> ConsistentCones:
    """Matches the cones of successive intervals, and transfers those without a match over the cuts, forwards and backwards.

    intervals, cuts : in order; one cut fewer than intervals
    threshold       : θ of Eq. 7, how far a leaf may move between two frames, mesh unit
    """
    least = (settings or ConeConsistencySettings()).least_overlap
    matches, erroneous = _matched_leaves(intervals, cuts, threshold, least)
    reliable = [
        [n for n in range(len(own.annulus)) if (i, n) not in erroneous and own.annulus[n].max(initial=-1) >= 0]
        for i, own in enumerate(intervals)
    ]
    leaf = [dict(enumerate(reliable[0]))]
    annulus = [{cone: intervals[0].annulus[n] for cone, n in leaf[0].items()}]
    count = len(leaf[0])
    for i, cut in enumerate(cuts):
        after = intervals[i + 1]
        transferred = {cone: transferred_annuli(a, cut.to_previous) for cone, a in annulus[i].items()}
        matched = {cone: matches[i][n] for cone, n in leaf[i].items() if matches[i].get(n, -1) in reliable[i + 1]}
        leaf.append(_identified(matched, reliable[i + 1], transferred, after, count, least))
        count += sum(cone >= count for cone in leaf[-1])
        annulus.append({**transferred, **{cone: after.annulus[n] for cone, n in leaf[-1].items()}})
    for i in range(len(cuts) - 1, -1, -1):
        for cone, own in annulus[i + 1].items():
            if cone not in annulus[i]:
                annulus[i][cone] = transferred_annuli(own, cuts[i].to_next)
    rows = tuple(
        np.array([of_cone[cone] for cone in range(count)], np.int64).reshape(count, len(own.area))
        for of_cone, own in zip(annulus, intervals, strict=True)
    )
    leaves = np.array([[here.get(cone, -1) for cone in range(count)] for here in leaf], np.int64)
    return ConsistentCones(rows, leaves.reshape(len(intervals), count))


def transferred_annuli(annulus: Ints, source: Ints) -> Ints:
    """Gives every vertex the annulus of the vertex that it is mapped onto, v_j' ∈ A^k if v_j ∈ A^k  (Eq. 8).

    Eq. 8 leaves the lost cone out of the vertices that may be mapped onto, and its second step asks what was mapped onto
    that cone; we leave the cone in.

    annulus : (vertex,) on one side of the cut, −1 beyond the cone
    source  : (vertex,) of each vertex on the other side its vertex on the first, −1 for none
    returns : (vertex,) on the other side
    """
    return np.where(source >= 0, annulus[source], -1)


def overlap(a: Ints, b: Ints, area: Floats) -> float:
    """Area common to two cones on one mesh, share of the smaller; 0 if one of them is empty.

    a, b : (vertex,) annulus in each, −1 beyond the cone
    area : (vertex,) mesh unit²
    """
    both, smaller = area[(a >= 0) & (b >= 0)].sum(), min(area[a >= 0].sum(), area[b >= 0].sum())
    return float(both / smaller) if smaller > 0.0 else 0.0


def _identified(
    matched: dict[int, int], reliable: list[int], transferred: dict[int, Ints], after: IntervalCones, count: int, least: float
) -> dict[int, int]:
    """The leaf of each cone behind a cut: matched ones, those whose cones overlap with a transferred one, and new ones."""
    leaf = dict(matched)
    unmatched = [cone for cone in transferred if cone not in leaf]
    for n in (n for n in reliable if n not in matched.values()):
        shares = [overlap(transferred[cone], after.annulus[n], after.area) for cone in unmatched]
        if shares and max(shares) >= least:
            leaf[unmatched.pop(int(np.argmax(shares)))] = n
        else:
            leaf[count], count = n, count + 1
    return leaf


def _matched_leaves(
    intervals: list[IntervalCones], cuts: list[Cut], threshold: float, least: float
) -> tuple[list[dict[int, int]], set[tuple[int, int]]]:
    """Of each cut the leaf behind it of each leaf before it; the erroneous cones as pairs of interval and leaf.

    Of two leaves that are farther apart than the threshold, the cone with fewer annuli is erroneous (Eq. 7). So it is (ours)
    of two leaves without a match whose cones overlap.
    """
    matches: list[dict[int, int]] = []
    erroneous: set[tuple[int, int]] = set()
    for i, cut in enumerate(cuts):
        a, b = intervals[i], intervals[i + 1]
        pairs = list(zip(cut.leaf_before.tolist(), cut.leaf_after.tolist(), cut.leaf_distance.tolist(), strict=True))
        matches.append({n: m for n, m, distance in pairs if distance <= threshold})
        doubtful = [(n, m) for n, m, distance in pairs if distance > threshold]
        single_before = [n for n in range(len(a.annulus)) if n not in cut.leaf_before]
        single_after = [m for m in range(len(b.annulus)) if m not in cut.leaf_after]
        doubtful += [
            (n, m)
            for n in single_before
            for m in single_after
            if overlap(transferred_annuli(a.annulus[n], cut.to_previous), b.annulus[m], b.area) >= least
        ]
        for n, m in doubtful:
            erroneous.add((i, n) if a.rank(n) < b.rank(m) else (i + 1, m))
    return matches, erroneous
