"""The frame to which all others are aligned, chosen without truth.

Where limbs touch, a reconstruction fuses them: leaves and Euler characteristic fall, and the surface that lies between
is lost to the area. A reference with a fused hand can never open it, so contact frames come last; among the others a pose
amid the others' poses leaves less to bend, and a place in the middle of the sequence fewer frames to go through.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.arrays import Floats

HANDLE = 0.01  # of the area: fingers fuse and part at the resolution of the grid, so one handle is weak evidence
POSE = 0.08  # of the area: for a pose as far from all others as is usual in the sequence
FOREIGN = 5.0  # times as far from all others as is usual: another body, or none
ASIDE = 0.05  # of the area: for a frame a whole sequence, or SHORT frames, away from its middle
SHORT = 20
LIMB = 0.02  # of the area: what skin stretches from pose to pose counts less than itself, what a limb loses more
STEADY = 2  # frames on either side that should be as free of contact


class Reference(NamedTuple):
    """The chosen frame and why.

    frame : its number
    free  : whether as many leaves are seen there and around as anywhere
    score : (frame,) at most 1, higher is better
    """

    frame: int
    free: bool
    score: Floats


def reference(leaves: npt.ArrayLike, euler: npt.ArrayLike, area: npt.ArrayLike, profile: Floats, stems: Floats) -> Reference:
    """The frame with most leaves, and among those one of large area, few handles, a pose amid all others, in the middle.

    Leaves, area and handles count as in the worst of a frame and its neighbours, so that frames just before or after
    contact, or beside one that lacks part of a limb, lose against frames amid freedom; where no frame is free, the least
    bad one is taken.

    leaves  : (frame,) number of leaves
    euler   : (frame,) vertices − edges + faces of the frame's clean mesh
    area    : (frame,) mesh unit²
    profile : (frame, quantile) quantiles over the surface of μ / area^1.5, which tell another body
    stems   : (leaf, frame, station, xyz) points along the limbs, mesh unit, which tell how they are bent; NaN where not seen
    returns : Reference; ties go to the frame nearest to the middle, then to the earlier one
    """
    count, characteristic, surface = (np.asarray(x, np.float64) for x in (leaves, euler, area))
    far = remoteness(unlikeness(profile))
    own = far <= FOREIGN
    missing = _worst_around(np.where(own, count[own].max() - count, count.max()))
    handles = _worst_around(np.where(own, characteristic[own].max() - characteristic, 0.0) / 2.0)
    distance = np.abs(np.arange(len(count)) - (len(count) - 1) / 2.0)
    lack = _worst_around(np.where(own, 1.0 - surface / surface[own].max(), 0.0))
    pose = POSE * remoteness(bending(stems / np.sqrt(surface)[:, None, None]))
    aside = ASIDE * distance / max(len(count), SHORT)
    score = 1.0 - missing - lack**2 / LIMB - HANDLE * handles - pose - aside - np.where(own, 0.0, far)
    frame = int(np.lexsort((distance, -np.round(score, 9)))[0])
    return Reference(frame, bool(missing[frame] == 0), score)


def profile(mu: Floats, area: Floats, quantiles: int = 100) -> Floats:
    """Quantiles of μ / (total area)^1.5 over the surface: the same for the same pose at any scale and tessellation.

    mu      : (vertex,) integral of geodesic distance weighted by area, mesh unit³
    area    : (vertex,) what each vertex stands for, mesh unit²
    returns : (quantile,) ascending, without unit
    """
    order = np.argsort(mu, kind="stable")
    total = np.cumsum(area[order])
    return np.interp((np.arange(quantiles) + 0.5) / quantiles, total / total[-1], mu[order]) / total[-1] ** 1.5


def unlikeness(profile: Floats) -> Floats:
    """Earth mover's distance between the values of any two frames.

    profile : (frame, quantile) ascending along each row
    returns : (frame, frame) in the unit of the values
    """
    # between distributions given by equally many quantiles the distance is the mean difference
    return np.array([np.abs(profile - row).mean(axis=1) for row in profile])


def bending(stems: Floats) -> Floats:
    """How differently limbs are held in any two frames: the mean change of straight distances between points on them.

    Straight distances see elbows and knees, which μ, made of geodesic ones, does not; which point is which is known.

    stems   : (leaf, frame, station, xyz) any unit; NaN where a leaf is not seen
    returns : (frame, frame) in that unit; the largest of all for two frames that see no limb in common, 0 without limbs
    """
    X = stems.transpose(1, 0, 2, 3).reshape(stems.shape[1], -1, 3)
    a, b = np.triu_indices(X.shape[1], 1)
    length = np.linalg.norm(X[:, a] - X[:, b], axis=2)
    seen = np.isfinite(length)
    length = np.where(seen, length, 0.0)
    out = np.full((len(X), len(X)), np.nan)
    for t, row in enumerate(length):
        both = seen & seen[t]
        total = both.sum(axis=1)
        change = np.where(both, np.abs(length - row), 0.0).sum(axis=1)
        out[t, total > 0] = change[total > 0] / total[total > 0]
    known = np.isfinite(out)
    return np.where(known, out, out[known].max(initial=0.0))


def remoteness(distance: Floats) -> Floats:
    """Mean distance of each frame to all frames, in units of its median over the sequence.

    distance : (frame, frame)
    returns  : (frame,) without unit; 0 everywhere if no frame differs from another
    """
    mean = distance.mean(axis=1)
    middle = float(np.median(mean))
    return mean / middle if middle > 0.0 else np.zeros(len(mean))


def _worst_around(lack: Floats) -> Floats:
    """(frame,) a frame's own lack or that of its neighbours, whichever is worse."""
    return np.array([lack[max(t - STEADY, 0) : t + STEADY + 1].max() for t in range(len(lack))])
