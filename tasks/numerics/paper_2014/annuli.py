"""Clusters of annuli that move as one, by self-, cast- and merge-error (2014, Sec. 6.1.2, Eqs. 9 to 12; Figs. 10 and 11)."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.geometry.rigid_fit import rigid_motion

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Bools = npt.NDArray[np.bool_]


class Step(NamedTuple):
    """Rigid motion from each frame to the next: x(t + 1) ≈ R x(t) + T.

    R : (step, 3, 3), T : (step, xyz) mesh unit
    """

    R: Floats
    T: Floats


class Clustered(NamedTuple):
    """The annuli of one cone or cylinder, from the leaf on.

    cluster : (annulus,) clusters are numbered along the cone
    merge   : (annulus,) mean merge-error of each annulus against the cluster before it; 1 for the first
    """

    cluster: Ints
    merge: Floats

    @property
    def rigid(self) -> Bools:
        """(annulus,) whether its cluster has other annuli; a single one is a joint, or part of one."""
        return np.asarray(np.bincount(self.cluster)[self.cluster] > 1)


def steps(x: Floats) -> Step:
    """The rigid motion of a sub-surface from frame to frame, D_{t→t+1}, by least squares (Eq. 9; Kabsch 1976).

    x : (frame, vertex, xyz) mesh unit
    """
    return Step(*rigid_motion(x[:-1], x[1:]))


def left(x: Floats, step: Step) -> Floats:
    """(step,) Σ_v |R v(t) + T − v(t + 1)|: the self-error if the motion is the sub-surface's own, else the cast-error (Eq. 10).

    x : (frame, vertex, xyz) mesh unit
    """
    moved = x[:-1] @ step.R.transpose(0, 2, 1) + step.T[:, None]
    return np.asarray(np.linalg.norm(moved - x[1:], axis=2).sum(axis=1), dtype=np.float64)


def merge_error(x: Floats, step: Step, floor: float) -> float:
    """Mean over steps of cast-error / self-error (Eqs. 11 and 12), at least 1 but for the norm; 1 where nothing moves.

    Eq. 11 is 0 / 0 for an annulus that keeps its shape exactly: what is left is taken as `floor` a vertex at least.

    x     : (frame, vertex, xyz) of an annulus, mesh unit
    step  : of the cluster it would join
    floor : mesh unit
    """
    if len(x) < 2:
        return 1.0
    least = max(floor * x.shape[1], 1e-300)
    return float((np.maximum(left(x, step), least) / np.maximum(left(x, steps(x)), least)).mean())


def clustered(annuli: list[Floats], threshold: float, floor: float) -> Clustered:
    """Walks from the leaf: an annulus joins the cluster before it if its merge-error is below the threshold.

    One that does not join stays by itself, and a new cluster begins with the annulus behind it (Sec. 6.1.2.3).

    annuli    : of each, (frame, vertex, xyz) mesh unit
    threshold : θ_r
    floor     : see `merge_error`
    """
    cluster, merge = np.zeros(len(annuli), np.int64), np.ones(len(annuli))
    first, number = 0, 0
    for k in range(1, len(annuli)):
        if first == k:
            cluster[k] = number
            continue
        merge[k] = merge_error(annuli[k], steps(np.concatenate(annuli[first:k], axis=1)), floor)
        if merge[k] < threshold:
            cluster[k] = number
        else:
            cluster[k] = number + 1
            first, number = k + 1, number + 2
    return Clustered(np.unique(cluster, return_inverse=True)[1].astype(np.int64), merge)
