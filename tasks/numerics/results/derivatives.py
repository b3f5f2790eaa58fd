"""Velocity and acceleration of sampled motion by local polynomials (Savitzky, Golay 1964)."""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats


class Derivatives(NamedTuple):
    """First and second derivative at every sample, and the number of samples that each is fitted to."""

    velocity: Floats
    acceleration: Floats
    samples: int


def derivatives(X: Floats, times: Floats, window: float, degree: int) -> Derivatives:
    """Derivatives of the polynomial that fits the samples around each time best  (Savitzky, Golay 1964).

    Every fit takes the same number of samples: as many as the window holds at the median spacing, rounded to an odd number that
    is greater than the degree; all where there are fewer. They are centred on each sample; at both ends, the first and the last
    ones are taken. At even spacing this is the filter of Savitzky and Golay; where samples are missing, their true times count.

    X       : (time, …) samples
    times   : (time,) ascending, seconds
    window  : seconds
    degree  : of the polynomials
    returns : (time, …) per second, (time, …) per second²; zeros for a single sample
    """
    count = len(times)
    if count < 2:
        return Derivatives(np.zeros_like(X), np.zeros_like(X), count)
    spacing = float(np.median(np.diff(times)))
    wanted = max(2 * round((window / spacing - 1.0) / 2.0) + 1, degree + 1 + degree % 2)
    samples = min(wanted, count)
    flat = X.reshape(count, -1)
    first, second = np.zeros_like(flat), np.zeros_like(flat)
    for t in range(count):
        begin = min(max(t - samples // 2, 0), count - samples)
        rows = slice(begin, begin + samples)
        powers = np.vander((times[rows] - times[t]) / spacing, min(degree, samples - 1) + 1, increasing=True)
        fitted = np.linalg.lstsq(powers, flat[rows], rcond=None)[0]
        first[t] = fitted[1] / spacing
        second[t] = 2.0 * fitted[2] / spacing**2 if len(fitted) > 2 else 0.0
    return Derivatives(first.reshape(X.shape), second.reshape(X.shape), samples)
