"""The largest connected piece of a surface: distances run over one piece only."""

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from kinetree.tasks.numerics.arrays import Faces, Floats, Ints
from kinetree.tasks.numerics.geometry.normals import face_areas


def largest_component(V: Floats, F: Faces) -> tuple[Ints, Ints, float]:
    """The vertices and faces of the piece with the greatest area; pieces are what shared vertices connect.

    V, F    : (vertex, xyz) mesh unit · (face, corner)
    returns : (kept vertex,) ascending numbers in V · (face, corner) of the piece, counted within the kept vertices ·
              the piece's share of the area, 1 where nothing has any area
    """
    links = coo_array((np.ones(2 * len(F), bool), (F[:, [0, 1]].ravel(), F[:, [1, 2]].ravel())), shape=(len(V), len(V)))
    count, piece = connected_components(links, directed=False)
    of_face = piece[F[:, 0]]
    areas = np.bincount(of_face, face_areas(V, F), count)
    largest = int(np.argmax(areas)) if areas.any() else int(of_face[0])
    inside = np.flatnonzero(piece == largest)
    number = np.full(len(V), -1)
    number[inside] = np.arange(len(inside))
    total = float(areas.sum())
    return inside, number[F[of_face == largest]], float(areas[largest]) / total if total else 1.0
