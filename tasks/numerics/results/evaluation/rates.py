"""The 2009 paper's measures of one frame: detection rate and mean distance to the nearest node (2009, Eqs. 7–9)."""

import numpy as np

from kinetree.tasks.numerics.arrays import Floats


def detection_rate(X: Floats, Y: Floats) -> Floats:
    """Share of the true joints that are the true joint nearest to their own nearest joint (2009, Eqs. 7, 8).

    R_detection = S / number of joints. Eq. 8 divides by the largest index, which is one less than the number of joints, so that
    a perfect result would have more than 1; this function divides by the number.

    X       : (frame, joint, xyz) joints of the result, mesh unit; at least one
    Y       : (frame, true, xyz) true joints, mesh unit; at least one
    returns : (frame,) 0 to 1
    """
    rates = np.zeros(len(Y))
    for t, (x, y) in enumerate(zip(X, Y, strict=True)):
        distance = np.linalg.norm(x[:, None] - y[None], axis=2)
        nearest = distance.argmin(axis=0)
        rates[t] = float((distance.argmin(axis=1)[nearest] == np.arange(len(y))).mean())
    return rates


def nearest_distance(X: Floats, Y: Floats) -> Floats:
    """Mean distance from a true joint to the nearest joint of the result (2009, Eq. 9).

    E_dist = Σ_i dist(m_i, n_i') / (i_max + 1)

    X       : (frame, joint, xyz) joints of the result, mesh unit
    Y       : (frame, true, xyz) true joints, mesh unit
    returns : (frame,) mesh unit; the paper divides by the height as well
    """
    rows = [np.linalg.norm(x[:, None] - y[None], axis=2).min(axis=0).mean() for x, y in zip(X, Y, strict=True)]
    return np.array(rows, dtype=np.float64)
