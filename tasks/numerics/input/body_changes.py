"""Where a sequence goes on with another body: a lasting step in volume that no pose and no lost limb makes (ours)."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints


class BodyChangeSettings(NamedTuple):
    """When two runs of frames are of two bodies.

    Chosen on thirteen recorded and fourteen generated sequences, all frames and every second, third and fifth, and twelve in
    which a limb is lost for good: no step above 0.021 that is also larger in volume than in area. Of 51 pairs of generated
    people and quadrupeds of other proportions 40 are told apart, and 39 with a step of 0.05.
    """

    window: int = 5
    """Frames on either side that are compared; a shorter visit of another body is not noticed."""
    step: float = 0.04
    """Least gap between the logarithms of the volumes on both sides: 4 %."""
    spread: float = 1.0
    """Least gap as a multiple of what either side varies by itself."""


def body_changes(area: Floats, volume: Floats, settings: BodyChangeSettings | None = None) -> Ints:
    """The frames with which another body begins.

    A lost limb takes more of the area than of the volume, since limbs are thin; a larger or heavier body has the more volume.

    area, volume : (frame,) length² and length³, in the order of time; a volume of 0 is not known
    returns      : places in the sequence, ascending
    """
    limit = settings or BodyChangeSettings()
    w = limit.window
    known = (volume > 0) & (area > 0)
    A, V = (np.log(np.where(known, x, 1.0)) for x in (area, volume))
    gap = np.zeros(len(V))
    for k in range(w, len(V) - w + 1):
        before, after = slice(k - w, k), slice(k, k + w)
        if not known[k - w : k + w].all():
            continue
        between = max(V[after].min() - V[before].max(), V[before].min() - V[after].max())
        is_wide = between > max(limit.step, limit.spread * max(np.ptp(V[before]), np.ptp(V[after])))
        in_volume, in_area = (abs(np.median(x[after]) - np.median(x[before])) for x in (V, A))
        gap[k] = between if is_wide and in_volume > in_area else 0.0
    return _peaks(gap)


def other_bodies(volume: Floats, begins: Ints, settings: BodyChangeSettings | None = None) -> Flags:
    """Which frames are not of the body that most frames show, the earliest of several that are shown equally often.

    volume  : (frame,) as above
    begins  : as `body_changes` returns
    returns : (frame,)
    """
    step = (settings or BodyChangeSettings()).step
    spans = [slice(a, b) for a, b in pairwise([0, *begins.tolist(), len(volume)])]
    usual = np.log([_median(volume[span]) for span in spans])
    same = np.abs(usual[:, None] - usual) <= step
    lengths = np.array([span.stop - span.start for span in spans])
    body = same[int((same @ lengths).argmax())]
    return np.repeat(~body, lengths)


def _median(volume: Floats) -> float:
    return float(np.median(volume[volume > 0]))


def _peaks(gap: Floats) -> Ints:
    """The largest of each run of neighbours that have a gap."""
    at = np.flatnonzero(gap)
    runs = np.split(at, np.flatnonzero(np.diff(at) > 1) + 1) if len(at) else []
    return np.array([run[gap[run].argmax()] for run in runs], dtype=np.int64)
