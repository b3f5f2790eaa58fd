"""Majorities and centroids over sets of vertices, for figures."""

from typing import Any

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.arrays import Floats, Ints

Numbers = npt.NDArray[np.integer[Any]]


def labels_of_rings(cone: Numbers, ring: Numbers, label: Numbers, area: Floats, shape: tuple[int, int]) -> Ints:
    """The label that most of the area of each ring of each cone has.

    cone, ring : (vertex,) cone of every vertex and its ring there, negative outside
    label      : (vertex,) 0 or more
    area       : (vertex,) any unit
    shape      : cones · rings
    returns    : (cone, ring) −1 where a ring is empty
    """
    labels = int(label.max(initial=-1)) + 1
    inside = (cone >= 0) & (ring >= 0)
    place = (cone[inside].astype(np.int64) * shape[1] + ring[inside]) * labels + label[inside]
    mass = np.bincount(place, area[inside], shape[0] * shape[1] * labels).reshape(*shape, labels)
    return np.where(mass.any(axis=2), mass.argmax(axis=2) if labels else -1, -1)


def centroids(V: Floats, label: Numbers, area: Floats, count: int) -> Floats:
    """Middles of the surface of every label.

    V, area : (vertex, xyz), (vertex,) mesh unit
    label   : (vertex,) below `count`
    returns : (label, xyz) mesh unit; 0 for labels that no vertex has
    """
    mass = np.maximum(np.bincount(label, area, count), np.finfo(float).tiny)
    return np.stack([np.bincount(label, area * V[:, k], count) / mass for k in range(3)], axis=1)
