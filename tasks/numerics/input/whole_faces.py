"""The faces of a mesh that are a piece of surface: three different corners, and no other face on the same three."""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Faces, Floats, Ints
from kinetree.tasks.numerics.geometry.normals import face_areas
from kinetree.tasks.numerics.geometry.orientation import lexicographic


class WholeFaces(NamedTuple):
    """The faces that stay, and how many were dropped for which reason.

    origin     : (whole,) rows of the input's faces, ascending
    area       : (whole,) squared unit of the vertices
    degenerate : with two equal corners
    duplicate  : with the corners of an earlier one
    folded     : back to back with another
    """

    origin: Ints
    area: Floats
    degenerate: int
    duplicate: int
    folded: int


def whole_faces(X: Floats, G: Faces, sheet: float) -> WholeFaces:
    """The faces of three different vertices, one for each set of corners.

    X     : (vertex, xyz)
    G     : (face, corner) indices into X after welding
    sheet : share of the area from which faces back to back are a sheet
    """
    whole = np.flatnonzero((G[:, 0] != G[:, 1]) & (G[:, 1] != G[:, 2]) & (G[:, 2] != G[:, 0]))
    area = face_areas(X, G[whole])
    distinct, folded = _distinct(G[whole], area, sheet, len(X))
    duplicate = len(whole) - folded - len(distinct)
    return WholeFaces(whole[distinct], area[distinct], len(G) - len(whole), duplicate, folded)


def _distinct(G: Faces, area: Floats, sheet: float, n: int) -> tuple[Ints, int]:
    """One face, the first, for each set of corners, without pairs back to back unless they are a sheet.

    G, area : (face, corner) three different vertices below n · (face,)
    sheet   : share of the area from which faces back to back are a sheet
    returns : rows to keep, ascending · how many faces were back to back and are not kept
    """
    rows = np.sort(G, axis=1)
    order = lexicographic(rows, n)
    start = np.flatnonzero(np.r_[True, (np.diff(rows[order], axis=0) != 0).any(axis=1)][: len(rows)])
    first = order[start]
    if len(first) == len(rows):
        return np.arange(len(rows)), 0
    ascents = (np.roll(G, -1, axis=1) > G).sum(axis=1)  # 2 one way round, 1 the other
    paired = np.add.reduceat(2 * ascents[order] - 3, start) == 0
    if area[first[paired]].sum() >= sheet * area[first].sum():
        paired[:] = False
    copies = np.diff(start, append=len(rows))
    return np.sort(first[~paired]), int(copies[paired].sum())
