"""How much of the skin near a joint follows no single part (ours).

Where skin blends over a wide range, several joints at several places explain its motion nearly alike.
"""

import numpy as np

from kinetree.tasks.numerics.arrays import Floats

NEAR = 0.06
"""Standard deviation of the normal law by whose density vertices count, roots of the area. From 0.04 to 0.09 the softness tells
badly placed joints of generated bodies alike."""


def skin_softness(V: Floats, area: Floats, weight: Floats, rest: Floats) -> Floats:
    """Mean share of the skinning weight that is not that of the heaviest joint, near every joint.

    V, area : (vertex, xyz) reference, mesh unit · (vertex,) mesh unit²
    weight  : (vertex, slot) skinning weights
    rest    : (joint, xyz) in the reference, mesh unit
    returns : (joint,) 0 where all skin near it is rigid, below 1
    """
    soft, size = 1.0 - weight.max(axis=1), np.sqrt(area.sum())
    out = np.empty(len(rest))
    for j, joint in enumerate(rest):
        square = np.square((V - joint) / (NEAR * size)).sum(axis=1)
        near = area * np.exp(-0.5 * (square - square.min()))
        out[j] = near @ soft / near.sum()
    return out
