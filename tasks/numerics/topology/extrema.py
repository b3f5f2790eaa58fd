"""Extrema: local maxima of μ that persist, at the ends of a body's limbs (2014, Sec. 5.1).

On a reconstructed surface μ has hundreds of tiny maxima. The end of a limb differs from a wrinkle by its persistence: how far
one must descend from it before a higher maximum can be reached, as a share of the range of μ on the body.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.topology.persistence import (
    in_faces,
    loop_counts,
    loop_spans,
    neighbours,
    region_above,
    superlevel_peaks,
)


class ExtremaSettings(NamedTuple):
    """What of the topology of one frame is compared between frames, beside its extrema."""

    least_peak: float = 0.02
    """Persistence, share of the range of μ, below which a maximum is noise whatever it is compared with. Free limbs have 0.25
    and more, other maxima up to 0.10; what lies below this never decides where a sequence is cut. Not varied so far."""
    levels: int = 200
    """Level sets of μ whose loops are counted: a loop's reach is known to a two-hundredth of the range. Not varied so far."""


class Extrema(NamedTuple):
    """Extrema of one frame, most persistent first; empty arrays on a body without limbs, such as a ball.

    vertex      : (extremum,) where μ is greatest
    persistence : (extremum,) share of max μ − min μ, from the threshold to 1
    level       : (extremum,) μ at which the limb joins that of another extremum; of a single one, the smallest μ
    """

    vertex: Ints
    persistence: Floats
    level: Floats


def extrema(mu: Floats, F: npt.NDArray[np.integer], threshold: float = 0.20, roundness: float = 0.05) -> Extrema:
    """Local maxima of μ with persistence of at least `threshold` · (max μ − min μ).

    mu        : (vertex,) finite at all vertices with a face, any unit
    F         : (face, corner)
    threshold : ends of free limbs have 0.25 and more; the elbow of an arm whose hand rests on the hip has up to 0.18
    roundness : a body on which μ varies by less than this share of its maximum is round and has no extrema
    returns   : Extrema; the highest maximum of each component has that component's whole range as its persistence
    """
    used = mu[in_faces(F, len(mu))] if len(F) else np.zeros(1)
    low, high = float(used.min()), float(used.max())
    span = high - low
    if span <= roundness * max(abs(low), abs(high)):
        return Extrema(np.zeros(0, np.int64), np.zeros(0), np.zeros(0))
    peaks = superlevel_peaks(mu, F, threshold * span)
    level = np.where(peaks.saddle >= 0, mu[peaks.saddle], low)
    for row in range(len(level)):
        # a limb ends where the first other limb joins it, whichever of the two is higher
        if peaks.into[row] >= 0:
            level[peaks.into[row]] = max(level[peaks.into[row]], mu[peaks.saddle[row]])
    return Extrema(peaks.vertex, peaks.persistence / span, level)


def stems(V: Floats, F: npt.NDArray[np.integer], mu: Floats, area: Floats, at: Extrema, stations: int = 4) -> Floats:
    """Centres of each extremum's limb at a few stations from its root to its end, the extremum itself last  (ours).

    Where limbs cross, their ends come near each other and their roots do not: leaves followed by whole stems are not
    swapped. A limb is the connected part around the extremum where μ is above `level`. It is divided into bands of equal
    height of μ, which move with the limb however it bends.

    V, F     : (vertex, xyz) mesh unit · (face, corner)
    mu       : (vertex,) as given to `extrema`
    area     : (vertex,) mesh unit²
    at       : extrema of this frame
    stations : bands; a band without area has the centre of the next one towards the extremum
    returns  : (extremum, stations + 1, xyz) mesh unit
    """
    start, ring = neighbours(F, len(V))
    S = np.empty((len(at.vertex), stations + 1, 3))
    for i, (end, level) in enumerate(zip(at.vertex, at.level, strict=True)):
        limb = region_above(mu, level, int(end), start, ring)
        band = np.minimum(((mu[limb] - level) * (stations / (mu[end] - level))).astype(np.int64), stations - 1)
        S[i, stations] = V[end]
        weight = np.bincount(band, area[limb], stations)
        sums = np.stack([np.bincount(band, area[limb] * V[limb, k], stations) for k in range(3)], axis=1)
        for s in range(stations - 1, -1, -1):
            S[i, s] = sums[s] / weight[s] if weight[s] > 0 else S[i, s + 1]
    return S


def peaks_and_loops(mu: Floats, F: npt.NDArray[np.integer], settings: ExtremaSettings | None = None) -> tuple[Floats, Floats]:
    """Two quantities that motion hardly changes and contact does: how high maxima of μ rise and how far loops reach  (ours).

    mu      : (vertex,) finite at all vertices with a face, any unit
    F       : (face, corner) at least one; μ must vary
    returns : (peak,) persistences of all maxima, share of max μ − min μ, highest first · (loop,) see `loop_spans`
    """
    chosen = settings or ExtremaSettings()
    span = float(np.ptp(mu[in_faces(F, len(mu))]))
    peaks = superlevel_peaks(mu, F, chosen.least_peak * span).persistence / span
    return np.sort(peaks)[::-1], loop_spans(loop_counts(mu, F, chosen.levels))
