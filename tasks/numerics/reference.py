"""The frame to which all others are aligned, chosen without truth.

Where limbs touch, a reconstruction fuses them: leaves and Euler characteristic fall, and the surface that lies between
is lost to the area. A reference with a fused hand can never open it, so contact frames come last; among the others a pose
amid the others' poses leaves less way to go.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]

HANDLE = 0.01  # of the area: fingers fuse and part at the resolution of the grid, so one handle is weak evidence
POSE = 0.08  # of the area: for a pose as far from all others as is usual in the sequence
FOREIGN = 5.0  # times as far from all others as is usual: another body, or none
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


def reference(leaves: npt.ArrayLike, euler: npt.ArrayLike, area: npt.ArrayLike, profile: Floats) -> Reference:
    """The frame with most leaves, and among those one of large area, few handles and a pose amid all others.

    Leaves and handles count as in the worst of a frame and its neighbours, so that frames just before or after contact
    lose against frames amid freedom; where no frame is free, the least bad one is taken.

    leaves  : (frame,) number of leaves
    euler   : (frame,) vertices − edges + faces of the frame's clean mesh
    area    : (frame,) mesh unit²
    profile : (frame, quantile) quantiles over the surface of μ / area^1.5, which change with the pose
    returns : Reference; ties go to the frame nearest to the middle, then to the earlier one
    """
    count, characteristic, surface = (np.asarray(x, np.float64) for x in (leaves, euler, area))
    far = remoteness(profile)
    own = far <= FOREIGN
    missing = _worst_around(np.where(own, count[own].max() - count, count.max()))
    handles = _worst_around(np.where(own, characteristic[own].max() - characteristic, 0.0) / 2.0)
    score = surface / surface[own].max() - missing - HANDLE * handles - POSE * far - np.where(own, 0.0, far)
    distance = np.abs(np.arange(len(score)) - (len(score) - 1) / 2.0)
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


def remoteness(profile: Floats) -> Floats:
    """Mean earth mover's distance of each frame's values to all frames', in units of its median over the sequence.

    profile : (frame, quantile) ascending along each row
    returns : (frame,) without unit; 0 everywhere if no frame differs from another
    """
    # between distributions given by equally many quantiles the distance is the mean difference
    distance = np.array([np.abs(profile - row).mean() for row in profile])
    middle = float(np.median(distance))
    return distance / middle if middle > 0.0 else np.zeros(len(profile))


def _worst_around(lack: Floats) -> Floats:
    """(frame,) a frame's own lack or that of its neighbours, whichever is worse."""
    return np.array([lack[max(t - STEADY, 0) : t + STEADY + 1].max() for t in range(len(lack))])
