"""Normals and areas of a mesh, of its faces and its vertices."""

from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.sparse import coo_array

from kinetree.tasks.numerics.arrays import Floats

Corners = npt.NDArray[np.integer[Any]]


def area_vectors(V: Floats, F: Corners) -> Floats:
    """Normals of faces, as long as the faces' areas.

    V, F    : (vertex, xyz) mesh unit · (face, corner)
    returns : (face, xyz) mesh unit²
    """
    a, b, c = V[F[:, 0]], V[F[:, 1]], V[F[:, 2]]
    return np.asarray(0.5 * np.cross(b - a, c - a), np.float64)


def face_areas(V: Floats, F: Corners) -> Floats:
    """(face,) area of every face, mesh unit²; V, F as in `area_vectors`."""
    return np.asarray(np.linalg.norm(area_vectors(V, F), axis=1), np.float64)


def vertex_areas(V: Floats, F: Corners) -> Floats:
    """The area that each vertex stands for: a third of the faces around it.

    V, F    : (vertex, xyz) mesh unit · (face, corner)
    returns : (vertex,) mesh unit², summing to the surface's area
    """
    return np.asarray(np.bincount(F.ravel(), np.repeat(face_areas(V, F) / 3, 3), len(V)), np.float64)


def vertex_normals(V: Floats, F: Corners) -> Floats:
    """Area-weighted vertex normals.

    V, F    : (vertex, xyz) mesh unit · (face, corner)
    returns : (vertex, xyz) unit; 0 for a vertex in no face and where faces cancel
    """
    faces = area_vectors(V, F)
    total = [np.bincount(F.ravel(), np.repeat(faces[:, x], 3), len(V)).astype(np.float64) for x in range(3)]
    return _unit(np.stack(total, axis=1))


def smoothed_normals(V: Floats, F: Corners, rounds: int = 2) -> Floats:
    """Area-weighted vertex normals, averaged over each vertex and its neighbours a few times, against noise.

    V, F    : (vertex, xyz) mesh unit · (face, corner)
    rounds  : how often to average
    returns : (vertex, xyz) unit; 0 for a vertex in no face
    """
    tail, head = F.ravel(), F[:, [1, 2, 0]].ravel()
    N = vertex_normals(V, F)
    around = coo_array((np.ones(2 * len(tail)), (np.r_[tail, head], np.r_[head, tail])), shape=(len(V), len(V))).tocsr()
    for _ in range(rounds):
        # an inner edge is counted twice by its two faces, and so is the vertex itself
        N = _unit(2.0 * N + around @ N)
    return N


def _unit(N: Floats) -> Floats:
    """Each row divided by its length; 0 where it has none."""
    length = np.linalg.norm(N, axis=1, keepdims=True)
    return np.divide(N, length, out=np.zeros_like(N), where=length > 0)
