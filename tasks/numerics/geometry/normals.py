"""Normals of a mesh that do not follow its noise."""

from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.sparse import coo_array

Floats = npt.NDArray[np.float64]


def smoothed_normals(V: Floats, F: npt.NDArray[np.integer[Any]], rounds: int = 2) -> Floats:
    """Area-weighted vertex normals, averaged over each vertex and its neighbours a few times.

    V, F    : (vertex, xyz) mesh unit · (face, corner)
    rounds  : how often to average
    returns : (vertex, xyz) unit; 0 for a vertex in no face
    """
    tail, head = F.ravel(), F[:, [1, 2, 0]].ravel()
    corner = np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]])
    total = [np.bincount(tail, np.repeat(corner[:, x], 3), len(V)).astype(np.float64) for x in range(3)]
    N = _unit(np.stack(total, axis=1))
    around = coo_array((np.ones(2 * len(tail)), (np.r_[tail, head], np.r_[head, tail])), shape=(len(V), len(V))).tocsr()
    for _ in range(rounds):
        # an inner edge is counted twice by its two faces, and so is the vertex itself
        N = _unit(2.0 * N + around @ N)
    return N


def _unit(N: Floats) -> Floats:
    length = np.linalg.norm(N, axis=1, keepdims=True)
    return np.divide(N, length, out=np.zeros_like(N), where=length > 0)
