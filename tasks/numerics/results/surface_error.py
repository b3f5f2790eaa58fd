"""How far the skinned mesh of a skeleton and the surface of one frame are from each other (ours)."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.closest_point import projected
from kinetree.tasks.numerics.geometry.inside import inside

Faces = npt.NDArray[np.integer]


class SurfaceError(NamedTuple):
    """Distances in one frame, mesh unit.

    distance : (vertex,) of the skinned mesh to the frame's surface
    skin     : (joint,) root mean square of these over the vertices of the joint's part; 0 for a joint without a part
    surface  : (joint,) root mean square distance of the frame's vertices to the skinned mesh, of those whose nearest point
               lies on the joint's part; 0 where there are none
    outside  : (joint,) how far the joint lies outside the frame's surface; 0 inside
    """

    distance: Floats
    skin: Floats
    surface: Floats
    outside: Floats


def surface_error(x: Floats, F: Faces, label: Ints, joints: Floats, V: Floats, G: Faces) -> SurfaceError:
    """Compares what is exported with what was put in.

    x       : (vertex, xyz) the skinned mesh in this frame, mesh unit
    F       : (face, corner) of the skinned mesh
    label   : (vertex,) joint whose part each of its vertices belongs to, −1 for none
    joints  : (joint, xyz) in this frame, mesh unit
    V, G    : (source, xyz) · (face, corner) the frame, mesh unit
    returns : SurfaceError
    """
    distance = projected(x, V, G).distance
    back = projected(V, x, F)
    corner = F[back.face, np.argmax(back.share, axis=1)]
    out = ~inside(joints, V, G)
    outside = np.zeros(len(joints))
    if out.any():
        outside[out] = projected(joints[out], V, G).distance
    count = len(joints)
    skin, surface = _root_mean_square(distance, label, count), _root_mean_square(back.distance, label[corner], count)
    return SurfaceError(distance, skin, surface, outside)


def _root_mean_square(distance: Floats, label: Ints, count: int) -> Floats:
    """(joint,) over the points of each label; points of label −1 count nowhere."""
    known = label >= 0
    number = np.bincount(label[known], minlength=count)
    square = np.bincount(label[known], distance[known] ** 2, minlength=count)
    return np.sqrt(square / np.maximum(number, 1))
