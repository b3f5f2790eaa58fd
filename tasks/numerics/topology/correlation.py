"""How alike the distributions of μ are in two frames: histograms and their correlation (2014, Sec. 4, Eq. 2).

Two normalisations. "frame" is the paper's letter: every frame's μ over its own minimum to maximum, one count a vertex;
it says nothing about the size of a change and follows the sampling. "sequence", the default: x = μ / A^{3/2}, weighted by
area, over the range of the whole sequence, smoothed. μ is an area times a length (mesh unit³), so that x has no unit and
does not change with scale; μ / A is the mean distance, and x that distance in units of √A.

Frames are compared by summaries, never by vertices: a summary is a histogram of 2,000 bins over the frame's own range.
"""

from typing import Literal, NamedTuple

import numpy as np
from scipy.ndimage import gaussian_filter1d

from kinetree.tasks.numerics.arrays import Floats

Normalisation = Literal["sequence", "frame"]


class CorrelationSettings(NamedTuple):
    """How the bins of a sequence are laid out."""

    least_range: float = 0.2
    """Range that the bins span at least, share of the largest x: a surface on which x varies by less has no limbs, and narrower
    bins would show its triangles. Not varied so far."""


def histograms(
    low: Floats,
    high: Floats,
    mass: Floats,
    normalisation: Normalisation = "sequence",
    bins: int = 100,
    smoothing: float = 2.0,
    settings: CorrelationSettings | None = None,
) -> Floats:
    """Histogram of every frame from its summary; each sums to 1.

    A fine bin that an edge cuts is split evenly, so that a bin's share is off by at most what the two fine bins at its
    ends hold; "frame" cuts none if `bins` divides their number.

    low, high : (frame,) range of x
    mass      : (frame, fine) see `mu_histogram.Summary`
    smoothing : standard deviation of a Gaussian in bins, for "sequence" only: motion shifts sharp peaks, contact moves mass
    returns   : (frame, bin)
    """
    if normalisation == "frame":
        return np.stack([_rebinned(np.linspace(a, b, bins + 1), a, b, m) for a, b, m in zip(low, high, mass, strict=True)])
    least = (settings or CorrelationSettings()).least_range
    first, last = float(low.min()), float(high.max())
    missing = max(0.0, least * max(abs(first), abs(last)) - (last - first)) or (0.0 if last > first else 1.0)
    edges = np.linspace(first - missing / 2, last + missing / 2, bins + 1)
    H = np.stack([_rebinned(edges, a, b, m) for a, b, m in zip(low, high, mass, strict=True)])
    return gaussian_filter1d(H, smoothing, axis=1, mode="reflect") if smoothing > 0 else H


def correlations(H: Floats, lag: int = 1) -> Floats:
    """C(t) = Cov(H(t), H(t + lag)) / (σ(H(t)) σ(H(t + lag)))  (2014, Eq. 2).

    Equal histograms have C = 1, flat ones too, where Eq. 2 is 0 / 0; a flat one against any other has C = 0.

    H       : (frame, bin)
    returns : (frame − lag,) within −1 … 1; empty if there are no more frames than `lag`
    """
    a, b = H[: max(len(H) - lag, 0)], H[lag:]
    a, b = a - a.mean(axis=1, keepdims=True), b - b.mean(axis=1, keepdims=True)
    spread = np.sqrt(np.sum(a * a, axis=1) * np.sum(b * b, axis=1))
    flat = spread <= 1e-30
    C = np.clip(np.sum(a * b, axis=1) / np.where(flat, 1.0, spread), -1.0, 1.0)
    equal = np.all(a == b, axis=1)
    return np.where(equal, 1.0, np.where(flat, 0.0, C))


def _rebinned(edges: Floats, low: float, high: float, mass: Floats) -> Floats:
    """(bin,) share of a frame's weight between the edges, which enclose its range; the last edge belongs to its bin."""
    if high > low:
        below = np.interp(edges, np.linspace(low, high, len(mass) + 1), np.concatenate([[0.0], np.cumsum(mass)]))
    else:
        below = (edges > low).astype(np.float64)
    below[0], below[-1] = 0.0, 1.0
    return np.diff(below)
