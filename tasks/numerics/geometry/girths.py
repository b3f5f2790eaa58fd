"""Rings about a limb: where a surface has one distance from something, how long that line is, and where its middle lies."""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints


class Girths(NamedTuple):
    """Rings at equal distances, ascending.

    level  : (ring,) distance, mesh unit
    girth  : (ring,) length of all lines at that distance together, mesh unit
    centre : (ring, xyz) their middle
    """

    level: Floats
    girth: Floats
    centre: Floats


def girths(V: Floats, F: Ints, distance: Floats, step: float) -> Girths:
    """Rings at whole multiples of a step, as far as the surface goes, without those of no length.

    V, F     : (vertex, xyz) mesh unit · (face, corner)
    distance : (vertex,) mesh unit; faces with a corner at no finite distance have no ring
    step     : above 0, mesh unit
    """
    near = F[np.isfinite(distance[F]).all(axis=1)]
    order = np.argsort(distance[near], axis=1)
    corner = np.take_along_axis(near, order, axis=1)
    d = distance[corner]
    low = np.ceil(d[:, 0] / step).astype(np.int64)
    count = np.maximum(np.ceil(d[:, 2] / step).astype(np.int64) - low, 0)
    face = np.repeat(np.arange(len(near)), count)
    level = np.arange(len(face)) - np.repeat(np.cumsum(count) - count, count) + low[face]
    P, s, d = V[corner[face]], level * step, d[face]
    first = _crossing(P[:, 0], P[:, 2], d[:, 0], d[:, 2], s)
    lower = s < d[:, 1]
    second = np.where(
        lower[:, None], _crossing(P[:, 0], P[:, 1], d[:, 0], d[:, 1], s), _crossing(P[:, 1], P[:, 2], d[:, 1], d[:, 2], s)
    )
    length = np.linalg.norm(second - first, axis=1)
    used, row = np.unique(level, return_inverse=True)
    girth: Floats = np.bincount(row, length, len(used)).astype(np.float64)
    sums = np.stack([np.bincount(row, length * x, len(used)) for x in ((first + second) / 2.0).T], axis=1)
    has_length = girth > 0.0
    multiple = used[has_length].astype(np.float64)
    return Girths(step * multiple, girth[has_length], sums[has_length] / girth[has_length, None])


def _crossing(a: Floats, b: Floats, da: Floats, db: Floats, s: Floats) -> Floats:
    """(row, xyz) where edges from a to b reach a distance s."""
    share = (s - da) / np.where(db > da, db - da, 1.0)
    return np.asarray(a + share[:, None] * (b - a))
