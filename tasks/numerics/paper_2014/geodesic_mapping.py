"""The vertices of another frame that have the nearest geodesic coordinates (2014, Sec. 5.3, Eqs. 5 and 6)."""

import numpy as np
from scipy.spatial import cKDTree

from kinetree.tasks.numerics.arrays import Floats, Ints


def nearest_in_coordinates(coordinates: Floats, X: Floats) -> tuple[Ints, Floats]:
    """The vertex of the next frame whose coordinates are nearest to each point's: argmin_v' |x(v) − x(v')|  (2014, Eqs. 5–6).

    Leaves that one of the two frames does not see do not count (ours).

    coordinates : (leaf, point) geodesic coordinates in the frame before, mesh unit; NaN where there are none
    X           : (leaf, vertex) those of all vertices of the next frame, mesh unit; NaN where there are none
    returns     : (point,) vertex, −1 for a point without coordinates and where no leaf is common · (point,) |x(v) − x(v')|,
                  mesh unit, NaN there
    """
    image, distance = np.full(coordinates.shape[1], -1), np.full(coordinates.shape[1], np.nan)
    common = np.isfinite(coordinates).any(axis=1) & np.isfinite(X).any(axis=1)
    if common.any():
        known = np.flatnonzero(np.isfinite(coordinates[common]).all(axis=0))
        candidates = np.flatnonzero(np.isfinite(X[common]).all(axis=0))
        distance[known], nearest = cKDTree(X[common][:, candidates].T).query(coordinates[common][:, known].T)
        image[known] = candidates[nearest]
    return image, distance


def image_coordinates(coordinates: Floats, X: Floats, image: Ints) -> Floats:
    """The coordinates of the images; where the frame has none, those before, since they do not change (Sec. 5.2).

    coordinates : (leaf, point) in the frame before, mesh unit; NaN where there are none
    X           : (leaf, vertex) of all vertices of this frame, mesh unit; NaN where there are none
    image       : (point,) vertex of this frame, −1 for none
    returns     : (leaf, point) mesh unit
    """
    new = np.where(image >= 0, X[:, image], np.nan)
    return np.where(np.isnan(new), coordinates, new)
