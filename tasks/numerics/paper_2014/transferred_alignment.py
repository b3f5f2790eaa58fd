"""Positions for the vertices of the model mesh that no map over the cuts reaches (ours)."""

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.geometry.rigid_fit import rigid_motion


class TransferredAlignmentSettings(NamedTuple):
    """What a vertex without a position follows."""

    neighbours: int = 12
    """Nearest vertices at rest whose rigid motion a vertex without a position follows. Not recorded what it was chosen on;
    three determine the motion, many reach over joints."""


def completed(rest: Floats, x: Floats, settings: TransferredAlignmentSettings | None = None) -> Floats:
    """(vertex, xyz) positions of all vertices, mesh unit: one without a position moves rigidly with the nearest that have one.

    rest : (vertex, xyz) the mesh at rest, where every vertex is known, mesh unit
    x    : (vertex, xyz) in a frame, mesh unit; NaN where not known. All are as at rest if none is known
    """
    neighbours = (settings or TransferredAlignmentSettings()).neighbours
    known = np.isfinite(x[:, 0])
    if not known.any():
        return rest.copy()
    out, missing = x.copy(), np.flatnonzero(~known)
    if len(missing):
        there = np.flatnonzero(known)
        nearest = cKDTree(rest[there]).query(rest[missing], k=min(neighbours, len(there)))[1]
        near = there[nearest.reshape(len(missing), -1)]
        R, t = rigid_motion(rest[near], x[near])
        out[missing] = np.einsum("vxy,vy->vx", R, rest[missing]) + t
    return out
