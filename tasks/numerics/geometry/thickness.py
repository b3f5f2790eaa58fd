"""How thick a body is at every point of its surface: the way through it to the other side."""

import numpy as np
from scipy.spatial import cKDTree

from kinetree.tasks.numerics.arrays import Floats, Ints

_NORMAL_WEIGHT = 0.1
"""What a difference of normals counts against distance, share of the size: enough that a neighbour is never the other side."""
_CANDIDATES = 4
"""Nearest points with opposite normals that are tried."""


def opposite(V: Floats, N: Floats, size: float, vertex: Ints) -> tuple[Ints, Floats]:
    """Vertices on the other side of the body, sought among points whose normals are opposite.

    V, N    : (vertex, xyz) mesh unit · (vertex, xyz) unit
    size    : of the body, mesh unit
    vertex  : (row,) the vertices asked for
    returns : (row, 4) vertices · (row, 4) distance to each, mesh unit; infinite where the way there leads out of the body,
              and where the body is thicker than a fifth of its size: then nearer points are found, on the same side
    """
    count = min(_CANDIDATES, len(V))
    tree = cKDTree(np.hstack([V, _NORMAL_WEIGHT * size * N]))
    other_side = tree.query(np.hstack([V[vertex], -_NORMAL_WEIGHT * size * N[vertex]]), k=count)[1].reshape(len(vertex), count)
    way = V[other_side] - V[vertex, None]
    length = np.linalg.norm(way, axis=2)
    inwards = np.einsum("vkx,vx->vk", way, N[vertex]) < -0.5 * length
    return other_side, np.where(inwards, length, np.inf)


def thickness(V: Floats, N: Floats, size: float) -> Floats:
    """Shortest way through the body from each vertex.

    V, N    : (vertex, xyz) mesh unit · (vertex, xyz) unit
    size    : of the body, mesh unit
    returns : (vertex,) mesh unit; infinite where the body is thicker than a fifth of its size
    """
    return opposite(V, N, size, np.arange(len(V)))[1].min(axis=1)
