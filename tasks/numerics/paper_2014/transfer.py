"""From one mesh over another to a third, vertex by vertex: how labels come back from interval to interval."""

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from kinetree.tasks.numerics.geometry.rigid_fit import rigid_motion

AROUND = 12
"""Vertices whose motion one without a place follows."""

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


def landed(P: Floats, x: Floats, area: Floats, way: Ints) -> tuple[Ints, Floats]:
    """The vertex of the third mesh at each point: that of the nearest vertex of the second which has one.

    P       : (point, xyz) mesh unit
    x, area : (vertex, xyz) of the second, (vertex,) 0 for vertices that do not count
    way     : (vertex,) vertex of the third, −1 for none
    returns : (point,) −1 if no vertex leads on · (point,) how far the nearest is, mesh unit
    """
    leads = np.flatnonzero((way >= 0) & (area > 0.0))
    if not len(leads):
        return np.full(len(P), -1), np.full(len(P), np.nan)
    away, nearest = cKDTree(x[leads]).query(P)
    return way[leads[nearest]], np.asarray(away, dtype=np.float64)


def first_corners(vertices: int, F: Ints) -> tuple[Ints, Floats]:
    """(vertex,) the first face around each vertex, −1 for none · (vertex, corner) 1 at the corner of that face which it is."""
    face, share = np.full(vertices, -1), np.zeros((vertices, 3))
    used, first = np.unique(F.ravel(), return_index=True)
    face[used] = first // 3
    share[used, first % 3] = 1.0
    return face, share


def completed(rest: Floats, place: Floats) -> Floats:
    """(vertex, xyz) places of all vertices: one that has none moves rigidly with the nearest that have.

    rest  : (vertex, xyz) the mesh where every vertex is known
    place : (vertex, xyz) in a frame, NaN where there is no way; all are as at rest if none has one
    """
    known = np.isfinite(place[:, 0])
    if not known.any():
        return rest.copy()
    out, bare = place.copy(), np.flatnonzero(~known)
    if len(bare):
        there = np.flatnonzero(known)
        near = there[cKDTree(rest[there]).query(rest[bare], k=min(AROUND, len(there)))[1].reshape(len(bare), -1)]
        R, t = rigid_motion(rest[near], place[near])
        out[bare] = np.einsum("vxy,vy->vx", R, rest[bare]) + t
    return out
