"""Where a long part's own axis expects its joint: the flesh around a hip lies to one side of it, the thigh does not."""

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

SHARE = 0.5
"""How far from the middle of its border towards its axis a joint is expected."""
LONG = (1.8, 2.2)
"""Spread of a part along its axis by that across it, from which on it has one, and in full."""
ASTRAY = (0.7, 1.1)
"""Distance of the axis from the border's middle, in radii of the border, from which on it is believed less, and not at all."""


def towards_axes(V: Floats, area: Floats, label: Ints, W: Floats, parents: Ints, expected: Floats, radius: Floats) -> Floats:
    """(joint, xyz) the places where joints are expected, moved towards the axes of the long parts that hang on them.

    Only of parts on which one other hangs, as a thigh: a hand or a foot may lie across its joint, a trunk has no axis.

    V, area  : (vertex, xyz), (vertex,) mesh unit
    label    : (vertex,) part, W : (vertex, part) skinning weights
    parents  : (part,) −1 for the root, parents before children
    expected : (joint, xyz) of every part but the root, radius : (joint,) of its border, mesh unit
    """
    out = expected.copy()
    for part in range(1, len(parents)):
        mass = area * np.where(label == part, W[:, part], 0.0) ** 2
        if np.count_nonzero(parents == part) != 1 or mass.sum() <= 0.0:
            continue
        middle = mass @ V / mass.sum()
        from_middle = V - middle
        variance, axes = np.linalg.eigh((mass[:, None] * from_middle).T @ from_middle / mass.sum())
        across = max(float(np.sqrt(variance[:2].mean())), np.finfo(float).tiny)
        at, axis = expected[part - 1], axes[:, 2]
        way = middle + axis * ((at - middle) @ axis) - at
        astray = float(np.linalg.norm(way)) / max(float(radius[part - 1]), np.finfo(float).tiny)
        out[part - 1] += SHARE * _ramp(np.sqrt(variance[2]) / across, *LONG) * (1.0 - _ramp(astray, *ASTRAY)) * way
    return out


def _ramp(value: float, low: float, high: float) -> float:
    """0 up to `low`, 1 from `high` on."""
    return float(np.clip((value - low) / (high - low), 0.0, 1.0))
