"""Geodesic coordinates: the distances of every vertex to the leaves (2014, Sec. 5.2, Eq. 4)."""

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.geometry.components import largest_component
from kinetree.tasks.numerics.geometry.geodesic_distance import geodesic_distance
from kinetree.tasks.numerics.geometry.surface import Surface


def geodesic_coordinates(V: Floats, F: npt.NDArray[np.integer], leaf: npt.ArrayLike) -> Floats:
    """x_n(v) = g(v, leaf_n), the distance of every vertex to each leaf over the surface  (2014, Eq. 4).

    V, F    : (vertex, xyz) mesh unit · (face, corner)
    leaf    : (leaf,) vertices of the largest component; may be none
    returns : (leaf, vertex) mesh unit; NaN outside the largest component
    """
    inside, inner, _ = largest_component(V, np.asarray(F, np.int32))
    out = np.full((np.size(leaf), len(V)), np.nan)
    if np.size(leaf):
        out[:, inside] = geodesic_distance(Surface.of(V[inside], inner), np.searchsorted(inside, leaf))
    return out
