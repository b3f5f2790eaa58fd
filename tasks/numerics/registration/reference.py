"""The frame to which all others are aligned, chosen without truth.

Where limbs touch, a reconstruction fuses them: leaves and Euler characteristic fall, and the surface that lies between
is lost to the area. A reference with a fused hand can never open it, so contact frames come last; among the others a pose
near the others' poses leaves less to bend, and a frame in the middle of the sequence has fewer frames to track through.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.arrays import Floats, Ints


class ReferenceSettings(NamedTuple):
    """What lowers the score of a frame, and by how much; a missing leaf lowers it by 1.

    Which quantities count was chosen on nine sequences with truth; how their weights were chosen is not recorded.
    """

    own: float = 0.5
    """For every leaf missing in the frame itself, beside 1 for it in the worst of the frames around. Any value from 0.1 to 1
    chooses the same frame of a recorded dance at a quarter of its rate, on which it was chosen, and of eleven others."""
    handle: float = 0.01
    """For every handle: fingers fuse and part at the resolution of the grid, so one handle is weak evidence of contact."""
    pose: float = 0.08
    """For a pose as far from all others as the median of the sequence."""
    foreign: float = 5.0
    """A frame farther than this from all others by μ, in medians of the sequence, shows another body, or none."""
    aside: float = 0.05
    """For a frame a whole sequence, or `short` frames, away from the middle."""
    short: int = 20
    """Frames below which a sequence counts as this long."""
    area: float = 0.02
    """The square of the share of area that is missing is divided by this: skin stretches by 1 %, a forearm is 5 %."""
    steady: int = 2
    """Frames on either side that should be as free of contact."""
    unlike: float = 1.0
    """A frame on either side says nothing of one whose pose lies farther from its own, in medians of all pairs of frames. The
    frame after the next lies at 0.2 to 0.7 (median of a sequence) where motion is slow, at 1.1 to 1.3 in every fourth frame of
    wave, dance and wolf."""
    still: float = 0.02
    """Poses that lie nearer than that, share of the root of the area, are alike, however near all others lie: of a body that
    hardly moves. Medians of the sequences above are 0.034 to 0.090, of people who look about 0.009 and 0.015."""


class Reference(NamedTuple):
    """The chosen frame and why.

    frame : its number
    free  : whether as many leaves are seen there and around as anywhere
    score : (frame,) at most 1, higher is better
    """

    frame: int
    free: bool
    score: Floats


def reference(
    leaves: npt.ArrayLike,
    euler: npt.ArrayLike,
    area: npt.ArrayLike,
    profile: Floats,
    stems: Floats,
    settings: ReferenceSettings | None = None,
    frame: int | None = None,
    takes: Sequence[slice] | None = None,
) -> Reference:
    """The frame with most leaves; among those one of large area, few handles, a pose near all others, in the middle (ours).

    Leaves, area and handles count as in the worst of a frame and its neighbours of a pose like its own, so that frames just
    before or after contact, or beside one that lacks part of a limb, score lower; in fast motion a neighbour has another pose
    and says nothing of it. A frame's own missing leaves count once more.

    leaves  : (frame,) number of leaves
    euler   : (frame,) vertices − edges + faces of the frame's clean mesh
    area    : (frame,) mesh unit²
    profile : (frame, quantile) quantiles over the surface of μ / area^1.5, by which another body is recognised
    stems   : (leaf, frame, station, xyz) points along the limbs, mesh unit, which show how limbs are bent; NaN where not seen
    takes   : positions of the frames of each take; None takes all as one
    frame   : position of the frame that is taken whatever its score; None takes the best
    returns : Reference; ties go to the frame nearest to the middle, then to the earlier one
    """
    settings = settings or ReferenceSettings()
    count, characteristic, surface = (np.asarray(x, np.float64) for x in (leaves, euler, area))
    far = remoteness(unlikeness(profile))
    own = far <= settings.foreign
    spans = takes or [slice(0, len(count))]
    bent = bending(stems / np.sqrt(surface)[:, None, None])
    around = _alike_around(bent, settings, spans)
    lost = np.where(own, count[own].max() - count, count.max())
    missing = _worst(lost, around)
    handles = _worst(np.where(own, characteristic[own].max() - characteristic, 0.0) / 2.0, around)
    frames = np.concatenate([np.full(s.stop - s.start, s.stop - s.start) for s in spans])
    distance = np.concatenate([np.abs(np.arange(s.stop - s.start) - (s.stop - s.start - 1) / 2.0) for s in spans])
    lack = _worst(np.where(own, 1.0 - surface / surface[own].max(), 0.0), around)
    pose = settings.pose * remoteness(bent)
    aside = settings.aside * distance / np.maximum(frames, settings.short)
    contact = missing + settings.own * lost + settings.handle * handles + lack**2 / settings.area
    score = 1.0 - contact - pose - aside - np.where(own, 0.0, far)
    frame = int(np.lexsort((distance, -np.round(score, 9)))[0]) if frame is None else frame
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


def _alike_around(bent: Floats, settings: ReferenceSettings, spans: Sequence[slice]) -> list[Ints]:
    """By frame, itself and the neighbours in its take that say something of it."""
    usual = float(np.median(bent[np.triu_indices(len(bent), 1)])) if len(bent) > 1 else 0.0
    most = max(settings.unlike * usual, settings.still)
    beside = [
        np.arange(max(t - settings.steady, s.start), min(t + settings.steady + 1, s.stop))
        for s in spans
        for t in range(s.start, s.stop)
    ]
    return [near[(bent[t, near] <= most) | (near == t)] for t, near in enumerate(beside)]


def _worst(lack: Floats, around: Sequence[Ints]) -> Floats:
    """(frame,) a frame's own lack or that of frames around it, whichever is worse."""
    return np.array([lack[near].max() for near in around])
