"""A coarser mesh on some of the vertices of a mesh."""

from threading import Lock

import numpy as np
import numpy.typing as npt
import trimesh
from scipy.spatial import cKDTree

from kinetree.tasks.numerics.arrays import Floats, Ints

_ONE_AT_A_TIME = Lock()
"""The library keeps its mesh in one place for the whole process: of two threads one would get the other's mesh."""


def decimated(V: Floats, F: npt.NDArray[np.integer], count: int) -> tuple[Ints, Ints]:
    """A coarser mesh on some of the vertices, so that it moves with them and keeps their labels.

    Quadric edge collapse (Garland, Heckbert 1997), every vertex then moved to the nearest one of the mesh.

    V, F    : (vertex, xyz) · (face, corner)
    count   : how many vertices, about
    returns : (kept,) vertices, ascending · (face, corner) into them; the mesh itself where it is small enough
    """
    faces = np.asarray(F, np.int64)
    if len(V) > count:
        whole = trimesh.Trimesh(V, faces, process=False)
        with _ONE_AT_A_TIME:
            coarse = whole.simplify_quadric_decimation(face_count=max(4, round(len(faces) * count / len(V))))
        nearest = cKDTree(V).query(coarse.vertices)[1]
        faces = nearest[np.asarray(coarse.faces, np.int64)]
        faces = faces[(faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])]
    chosen, corner = np.unique(faces, return_inverse=True)
    return chosen, corner.reshape(-1, 3).astype(np.int64)
