"""Vertices of a mesh as corners of its faces (ours)."""

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints


def first_corners(vertices: int, F: Ints) -> tuple[Ints, Floats]:
    """The first face around each vertex, and the vertex in barycentric coordinates of that face.

    vertices : number of vertices
    F        : (face, corner)
    returns  : (vertex,) face, −1 for a vertex without faces · (vertex, corner) 1 at the corner that is the vertex, else 0
    """
    face, share = np.full(vertices, -1), np.zeros((vertices, 3))
    used, first = np.unique(F.ravel(), return_index=True)
    face[used] = first // 3
    share[used, first % 3] = 1.0
    return face, share
