"""Vertices and places transferred between the references of intervals, over the cuts (ours, for 2014, Sec. 6.1.3)."""

import numpy as np
from scipy.spatial import cKDTree

from kinetree.tasks.numerics.arrays import Floats, Ints


def composed_map(to_next: list[Ints], to_previous: list[Ints], source: int, target: int, vertices: int) -> Ints:
    """The vertex of interval `target` at each vertex of interval `source`: the maps of all cuts between them, composed.

    to_next     : of each cut, (vertex,) of the interval before it its vertex in the one behind; −1 for none
    to_previous : of each cut, (vertex,) of the interval behind it its vertex in the one before; −1 for none
    vertices    : number of vertices of interval `source`
    returns     : (vertex,) −1 where one of the maps has none
    """
    image = np.arange(vertices)
    for cut in range(source, target) if target > source else range(source - 1, target - 1, -1):
        step = to_next[cut] if target > source else to_previous[cut]
        image = np.where(image >= 0, step[image], -1)
    return image


def mapped_positions(x: Floats, image: Ints) -> Floats:
    """(…, vertex, xyz) the positions of the images, mesh unit; NaN for a vertex without one.

    x     : (…, other vertex, xyz) mesh unit
    image : (vertex,) see `composed_map`
    """
    return np.where((image >= 0)[:, None], x[..., image, :], np.nan)


def nearest_image(P: Floats, x: Floats, area: Floats, image: Ints) -> tuple[Ints, Floats]:
    """The image of the vertex that is nearest to each point, among the vertices that have one.

    P       : (point, xyz) mesh unit
    x       : (vertex, xyz) mesh unit
    area    : (vertex,) mesh unit²; vertices with none do not count
    image   : (vertex,) vertex of a third mesh, −1 for none
    returns : (point,) vertex of the third mesh, −1 if no vertex has an image · (point,) distance to the nearest, mesh unit,
              NaN then
    """
    mapped = np.flatnonzero((image >= 0) & (area > 0.0))
    if not len(mapped):
        return np.full(len(P), -1), np.full(len(P), np.nan)
    distance, nearest = cKDTree(x[mapped]).query(P)
    return image[mapped[nearest]], np.asarray(distance, dtype=np.float64)
