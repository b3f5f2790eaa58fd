"""Clusters of annuli that move as one, by self-, cast- and merge-error (2014, Sec. 6.1.2, Eqs. 9 to 12; Figs. 10 and 11)."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.geometry.rigid_fit import rigid_motion


class FrameMotion(NamedTuple):
    """Rigid motion of a sub-surface from each frame to the next, D_{t→t+1}: x(t + 1) ≈ R x(t) + T.

    R : (transition, 3, 3)
    T : (transition, xyz) mesh unit
    """

    R: Floats
    T: Floats


class AnnulusClusters(NamedTuple):
    """The annuli of one cone or cylinder, from the leaf on.

    cluster     : (annulus,) number of its cluster; clusters are numbered along the cone
    merge_error : (annulus,) mean merge-error of each annulus against the cluster before it; 1 for the first of a cluster
    """

    cluster: Ints
    merge_error: Floats

    @property
    def rigid(self) -> Flags:
        """(annulus,) whether its cluster has other annuli; a single one is a joint, or part of one (Sec. 6.1.2.3)."""
        return np.asarray(np.bincount(self.cluster)[self.cluster] > 1)


def annulus_clusters(annuli: list[Floats], thresholds: Sequence[float], floor: float) -> list[AnnulusClusters]:
    """Joins annuli, from the leaf on, to the cluster before them where their merge-error is below a threshold (Eq. 12).

    An annulus that does not join stays single, and a new cluster begins with the annulus after it (Sec. 6.1.2.3).

    annuli     : of each, (frame, vertex, xyz) mesh unit
    thresholds : θ_r, several of them
    floor      : see `merge_error`
    returns    : the clusters at each threshold
    """
    known: dict[tuple[int, int], float] = {}

    def error(first: int, k: int) -> float:
        if (first, k) not in known:
            known[first, k] = merge_error(annuli[k], frame_motion(np.concatenate(annuli[first:k], axis=1)), floor)
        return known[first, k]

    return [_clustered(len(annuli), threshold, error) for threshold in thresholds]


def _clustered(count: int, threshold: float, error: Callable[[int, int], float]) -> AnnulusClusters:
    """Clusters at one threshold; error(first, k) is the merge-error of annulus k against the cluster from `first` to k − 1."""
    cluster, errors = np.zeros(count, np.int64), np.ones(count)
    first, number = 0, 0
    for k in range(1, count):
        if first == k:
            cluster[k] = number
            continue
        errors[k] = error(first, k)
        if errors[k] < threshold:
            cluster[k] = number
        else:
            cluster[k] = number + 1
            first, number = k + 1, number + 2
    return AnnulusClusters(np.unique(cluster, return_inverse=True)[1].astype(np.int64), errors)


def self_errors(annuli: list[Floats]) -> Floats:
    """(annulus,) self-error a vertex, mean over the transitions: the apparent non-rigidity (Sec. 6.1.2.1), mesh unit.

    annuli : of each, (frame, vertex, xyz) mesh unit
    """
    return np.array([residual_sums(x, frame_motion(x)).mean() / x.shape[1] if len(x) > 1 else 0.0 for x in annuli])


def least_rigid(rigid: Flags, self_error: Floats) -> Flags:
    """(annulus,) rigid annuli, each joint moved one annulus towards the leaf where it is less rigid there (ours).

    "Annuli in non-rigid motion are not merged to any others" (Sec. 6.1.2.3), but Eq. 11 merges an annulus that a joint crosses
    in its middle: where two halves turn by α against each other, the best motion of all leaves as much as the motion of one
    half, and the ratio is 1. The annulus after it, which is rigid, then does not join. So of the last annulus that joined and
    the last that did not, the one with the smaller self-error is rigid. The first annulus stays as it is.

    rigid      : (annulus,) after clustering, from the leaf on
    self_error : (annulus,) see `self_errors`
    """
    out = rigid.copy()
    for first in np.flatnonzero(~rigid[1:] & rigid[:-1]) + 1:
        last = first + int(np.argmax([*rigid[first:], True])) - 1
        if first > 1 and last + 1 < len(rigid) and self_error[first - 1] > self_error[last]:
            out[first - 1], out[last] = False, True
    return out


def merge_error(x: Floats, motion: FrameMotion, floor: float) -> float:
    """Mean over the transitions of cast-error / self-error (Eqs. 11 and 12); 1 for a single frame.

    Eq. 11 is 0 / 0 for an annulus that keeps its shape exactly: both errors are taken as `floor` a vertex at least (ours).

    x      : (frame, vertex, xyz) of an annulus, mesh unit
    motion : of the cluster that it would join
    floor  : mesh unit
    """
    if len(x) < 2:
        return 1.0
    least = max(floor * x.shape[1], 1e-300)
    cast, own = residual_sums(x, motion), residual_sums(x, frame_motion(x))
    return float((np.maximum(cast, least) / np.maximum(own, least)).mean())


def frame_motion(x: Floats) -> FrameMotion:
    """The rigid motion of a sub-surface from frame to frame, D_{t→t+1}, by least squares (Eq. 9; Kabsch 1976).

    x : (frame, vertex, xyz) mesh unit
    """
    return FrameMotion(*rigid_motion(x[:-1], x[1:]))


def residual_sums(x: Floats, motion: FrameMotion) -> Floats:
    """(transition,) Σ_v |R v(t) + T − v(t + 1)|, mesh unit: self-error for its own motion (Eq. 9), else cast-error (Eq. 10).

    x      : (frame, vertex, xyz) mesh unit
    motion : of this or of another sub-surface
    """
    moved = x[:-1] @ motion.R.transpose(0, 2, 1) + motion.T[:, None]
    return np.asarray(np.linalg.norm(moved - x[1:], axis=2).sum(axis=1), dtype=np.float64)
