"""Leaves: the tips of a body's extremities, local maxima of μ that persist (2014, §5.1).

On a reconstructed surface μ has hundreds of tiny maxima. What tells a tip from a wrinkle is how far one must descend from
it before a higher maximum is in reach, its persistence, measured against the range of μ on the body.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.topology.persistence import neighbours, region_above, superlevel_peaks


class Extrema(NamedTuple):
    """Tips of one frame, most persistent first; empty arrays if the body has none, as a ball has not.

    vertex      : (leaf,) the maximum of μ
    persistence : (leaf,) share of max μ − min μ, above the threshold to 1
    level       : (leaf,) μ at which the limb joins that of another leaf; of a single leaf, the smallest μ
    """

    vertex: Ints
    persistence: Floats
    level: Floats


def extrema(mu: Floats, F: npt.NDArray[np.integer], threshold: float = 0.20, roundness: float = 0.05) -> Extrema:
    """Local maxima of μ with persistence of at least `threshold` · (max μ − min μ).

    mu        : (vertex,) finite at all vertices with a face, any unit
    F         : (face, corner)
    threshold : tips of free limbs have 0.25 and more; the elbow of an arm whose hand rests on the hip has up to 0.18
    roundness : a body on which μ varies by less than this share of its maximum is round and has no leaves
    returns   : Leaves; the highest maximum of each component has that component's whole range as its persistence
    """
    used = mu[np.unique(F)] if len(F) else np.zeros(1)
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


def stems(V: Floats, F: npt.NDArray[np.integer], mu: Floats, area: Floats, found: Extrema, stations: int = 4) -> Floats:
    """Centres of each leaf's limb at a few stations from its root to its tip, the tip last.

    Tips of crossing limbs change places within a frame, their roots do not: whoever follows leaves by whole stems does
    not swap them. A limb is the connected part around the leaf where μ is above `level`; it is divided into bands of
    equal height of μ, which move with the limb however it bends.

    V        : (vertex, xyz) mesh unit
    mu       : (vertex,) as given to `leaves`
    area     : (vertex,) mesh unit²
    stations : bands; a band without area has the centre of the next one towards the tip
    returns  : (leaf, stations + 1, xyz) mesh unit
    """
    start, ring = neighbours(F, len(V))
    S = np.empty((len(found.vertex), stations + 1, 3))
    for i, (tip, level) in enumerate(zip(found.vertex, found.level, strict=True)):
        limb = region_above(mu, level, int(tip), start, ring)
        band = np.minimum(((mu[limb] - level) * (stations / (mu[tip] - level))).astype(np.int64), stations - 1)
        S[i, stations] = V[tip]
        weight = np.bincount(band, area[limb], stations)
        sums = np.stack([np.bincount(band, area[limb] * V[limb, k], stations) for k in range(3)], axis=1)
        for s in range(stations - 1, -1, -1):
            S[i, s] = sums[s] / weight[s] if weight[s] > 0 else S[i, s + 1]
    return S
