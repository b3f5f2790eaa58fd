"""Vertices and leaves of two successive intervals related at the cut between them (2014, Sec. 6.1.1.2 to 6.1.1.4)."""

import numpy as np
from scipy.spatial import cKDTree

from kinetree.tasks.numerics.arrays import Floats, Ints


def nearest_agreeing(P: Floats, N: Floats, Q: Floats, M: Floats) -> tuple[Ints, Floats]:
    """The nearest vertex of the other side, ε(v, U), where the normals agree, n(v)·n(ε) > 0  (2014, Eq. 8).

    P, N    : (vertex, xyz) mesh unit · (vertex, xyz) normals
    Q, M    : the same of the other side
    returns : (vertex,) of the other side, −1 where the normals do not agree or there is no other side · (vertex,)
              distance, mesh unit, infinite if there is no other side
    """
    if not len(Q):
        return np.full(len(P), -1), np.full(len(P), np.inf)
    distance, nearest = cKDTree(Q).query(P)
    agree = np.einsum("vx,vx->v", N, M[nearest]) > 0.0
    return np.where(agree, nearest, -1), distance


def mutual_pairs(P: Floats, N: Floats, Q: Floats, M: Floats) -> Ints:
    """Leaves that are each other's nearest across the cut and whose normals agree  (2014, Eq. 3 as Sec. 6.1.1.2 uses it).

    P, N, Q, M : as in `nearest_agreeing`, of leaves
    returns    : (pair, 2) rows of P and of Q, ascending
    """
    forwards, backwards = nearest_agreeing(P, N, Q, M)[0], nearest_agreeing(Q, M, P, N)[0]
    row = np.flatnonzero(forwards >= 0)
    row = row[backwards[forwards[row]] == row] if len(row) else row
    return np.stack([row, forwards[row]], axis=1)
