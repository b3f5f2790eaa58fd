"""Geodesic coordinates, and the vertices of another frame that have most nearly the same (2014, Sec. 5.2 and 5.3, Eqs. 4–6)."""

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from kinetree.tasks.numerics.geometry.components import largest_component
from kinetree.tasks.numerics.geometry.geodesic_distance import geodesic_distance
from kinetree.tasks.numerics.geometry.surface import Surface

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


def geodesic_coordinates(V: Floats, F: npt.NDArray[np.integer], leaf: npt.ArrayLike) -> Floats:
    """x_n(v) = g(v, leaf_n), the distance of every vertex to each leaf over the surface  (2014, Eq. 4).

    V, F    : (vertex, xyz) mesh unit · (face, corner)
    leaf    : (leaf,) vertices of the largest component; may be none
    returns : (leaf, vertex) mesh unit; NaN outside the largest component
    """
    kept, inner, _ = largest_component(V, np.asarray(F, np.int32))
    out = np.full((np.size(leaf), len(V)), np.nan)
    if np.size(leaf):
        out[:, kept] = geodesic_distance(Surface.of(V[kept], inner), np.searchsorted(kept, leaf))
    return out


def nearest_in_coordinates(place: Floats, X: Floats) -> tuple[Ints, Floats]:
    """The vertex of the next frame whose coordinates are nearest to each point's: argmin_v' |x(v) − x(v')|  (2014, Eqs. 5–6).

    Leaves that one of the two frames does not see do not count.

    place   : (leaf, point) coordinates in the frame before, mesh unit; NaN where there are none
    X       : (leaf, vertex) coordinates of all vertices of the next frame, mesh unit; NaN where there are none
    returns : (point,) vertex, −1 for a point without coordinates and where no leaf is common · (point,) |x(v) − x(v')|,
              mesh unit, NaN there
    """
    image, away = np.full(place.shape[1], -1), np.full(place.shape[1], np.nan)
    common = np.isfinite(place).any(axis=1) & np.isfinite(X).any(axis=1)
    if common.any():
        known = np.flatnonzero(np.isfinite(place[common]).all(axis=0))
        offered = np.flatnonzero(np.isfinite(X[common]).all(axis=0))
        away[known], nearest = cKDTree(X[common][:, offered].T).query(place[common][:, known].T)
        image[known] = offered[nearest]
    return image, away


def middle_frame(seen: npt.NDArray[np.bool_]) -> int:
    """The frame at the middle of an interval, or the one nearest to it of those that see the most of its leaves.

    seen    : (leaf, frame); in the paper every leaf is seen in every frame
    returns : position of the frame; of two as near to the middle, the earlier
    """
    count = seen.sum(axis=0)
    distance = np.abs(np.arange(len(count)) - (len(count) - 1) / 2.0)
    return int(np.lexsort((distance, -count))[0])


def own_tips(trail: Floats, tip: Floats) -> Ints:
    """Which of a frame's tips each leaf is, for a frame that is known by its tips alone.

    trail   : (leaf, frame, xyz) where each leaf is in every frame of the interval, NaN where it is not seen
    tip     : (tip, xyz) of one of these frames
    returns : (leaf,) tip, −1 where the leaf is not seen
    """
    if not len(tip) or not len(trail):
        return np.full(len(trail), -1)
    same = (trail[:, :, None] == tip[None, None]).all(axis=3)
    here = same[:, int(same.any(axis=2).sum(axis=0).argmax())]
    return np.where(here.any(axis=1), here.argmax(axis=1), -1)
