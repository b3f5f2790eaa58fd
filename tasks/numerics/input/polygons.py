"""Triangles of the polygons of a text, whose corners are kept as rows of numbers: lists of lists take ten times the memory."""

from array import array

import numpy as np

from kinetree.tasks.numerics.arrays import Ints


def triangles_of(corners: "array[int]", counts: "array[int]") -> tuple[Ints, Ints]:
    """The triangles of all polygons, in the order of trimesh: triangles, halves of quadrilaterals, fans of larger ones.

    corners : of one polygon after the other
    counts  : corners of each polygon, at least three
    returns : (face, corner) · (face,) the polygon of each
    """
    of, many = np.asarray(corners, dtype=np.int64), np.asarray(counts, dtype=np.int64)
    if (many == 3).all():
        return of.reshape(-1, 3), np.arange(len(many))
    begin = np.cumsum(many) - many
    three, four, more = np.flatnonzero(many == 3), np.flatnonzero(many == 4), np.flatnonzero(many > 4)
    fan = np.repeat(more, many[more] - 2)
    k = np.arange(len(fan)) - np.repeat(np.cumsum(many[more] - 2) - (many[more] - 2), many[more] - 2)
    F = [
        of[begin[three, None] + (0, 1, 2)],
        of[begin[four, None] + (0, 1, 2)],
        of[begin[four, None] + (2, 3, 0)],
        of[begin[fan, None] + np.stack([np.zeros_like(k), k + 1, k + 2], axis=1)],
    ]
    return np.concatenate(F), np.concatenate([three, four, four, fan])
