"""The 2009 paper's measures of one frame: detection rate and mean distance to the nearest node (2009, Eqs. 7–9)."""

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


def detection_rate(X: Floats, Y: Floats) -> Floats:
    """Share of the true joints that are the nearest of their nearest, R_detection = S / number of joints (2009, Eqs. 7, 8).

    Eq. 8 divides by the largest index, which is one less than there are joints; all of them found would be more than 1.

    X, Y    : (frame, joint, xyz) found and (frame, true, xyz) true, mesh unit; at least one of each
    returns : (frame,) 0 to 1
    """
    rates = np.zeros(len(Y))
    for t, (x, y) in enumerate(zip(X, Y, strict=True)):
        apart = np.linalg.norm(x[:, None] - y[None], axis=2)
        nearest = apart.argmin(axis=0)
        rates[t] = float((apart.argmin(axis=1)[nearest] == np.arange(len(y))).mean())
    return rates


def nearest_distance(X: Floats, Y: Floats) -> Floats:
    """Mean distance from a true joint to the nearest found one, E_dist = Σ_i dist(m_i, n_i') / (i_max + 1) (2009, Eq. 9).

    X, Y    : (frame, joint, xyz) found and (frame, true, xyz) true, mesh unit
    returns : (frame,) mesh unit; the paper divides by the height
    """
    rows = [np.linalg.norm(x[:, None] - y[None], axis=2).min(axis=0).mean() for x, y in zip(X, Y, strict=True)]
    return np.array(rows, dtype=np.float64)
