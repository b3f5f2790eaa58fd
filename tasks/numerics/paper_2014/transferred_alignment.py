"""Positions for the vertices of the model mesh that no map over the cuts reaches (ours)."""

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from kinetree.tasks.numerics.arrays import Floats


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
        P, Q = rest[near], x[near]
        p, q = P.mean(axis=1, keepdims=True), Q.mean(axis=1, keepdims=True)
        U, _, Vt = np.linalg.svd((P - p).transpose(0, 2, 1) @ (Q - q))
        Vt[:, 2] *= np.sign(np.linalg.det(U) * np.linalg.det(Vt))[:, None]
        out[missing] = ((rest[missing][:, None] - p) @ U @ Vt + q)[:, 0]
    return out
