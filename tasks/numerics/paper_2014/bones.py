"""Rigid and non-rigid areas of the whole surface, and the joints between them (2014, Sec. 6.3; Fig. 15)."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from kinetree.tasks.numerics.paper_2014.cones import edges
from kinetree.tasks.numerics.paper_2014.cylinders import Piece
from kinetree.tasks.numerics.structure.spanning_tree import spanning

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Bools = npt.NDArray[np.bool_]


class Areas(NamedTuple):
    """A partition of the surface.

    label : (vertex,) area
    rigid : (area,) whether it is rigid; the others are joints
    piece : (area,) the cone or cylinder that it is of, first, last : (area,) its annuli there
    """

    label: Ints
    rigid: Bools
    piece: Ints
    first: Ints
    last: Ints


def areas(pieces: list[Piece], vertices: int, F: Ints) -> Areas:
    """Contiguous annuli of a cone or cylinder that are all rigid, or all not, are one area.

    A vertex in no piece belongs to the area that is reached first over the edges.
    """
    label = np.full(vertices, -1)
    rows: list[tuple[bool, int, int, int]] = []
    for number, piece in enumerate(pieces):
        used = np.unique(piece.ring[piece.ring >= 0])
        for at, k in enumerate(used):
            rigid = bool(piece.rigid[k])
            if at == 0 or rows[-1][0] != rigid:
                rows.append((rigid, number, int(k), int(k)))
            rows[-1] = (*rows[-1][:3], int(k))
            label[piece.ring == k] = len(rows) - 1
    if not rows:
        return Areas(np.zeros_like(label), *(np.array([a]) for a in (True, 0, 0, 0)))
    E = edges(F)
    while (label < 0).any():
        before = label.copy()
        for a, b in (E.T, E[:, ::-1].T):
            bare = (before[b] < 0) & (before[a] >= 0)
            label[b[bare]] = before[a[bare]]
        if (label == before).all():
            label[label < 0] = 0
    return Areas(label, *(np.array(column) for column in zip(*rows, strict=True)))


def adjacent(label: Ints, F: Ints, count: int) -> Bools:
    """(area, area) which areas share an edge of the mesh."""
    a, b = label[edges(F)].T
    out = np.zeros((count, count), dtype=bool)
    out[a, b] = out[b, a] = True
    np.fill_diagonal(out, val=False)
    return out


def bodies(meets: Bools, rigid: Bools) -> Ints:
    """(area,) rigid areas with no joint between them are one body; −1 for areas that are not rigid.

    meets : (area, area) see `adjacent`
    """
    links = coo_array(meets & rigid[:, None] & rigid[None, :])
    of = connected_components(links, directed=False)[1]
    return np.where(rigid, np.unique(np.where(rigid, of, -1), return_inverse=True)[1] - int(not rigid.all()), -1)


def candidates(meets: Bools, body: Ints) -> tuple[Ints, Ints]:
    """Bones between joints whose areas are adjacent to one another or to the same rigid body (Sec. 6.3.1 and 6.3.2).

    returns : (bone, 2) areas that are joints · (bone,) the body between, −1 where they are adjacent to one another only
    """
    joint = np.flatnonzero(body < 0)
    touches = np.stack([meets[:, body == b].any(axis=1) for b in range(int(body.max(initial=-1)) + 1)] or [meets[:, 0] & False])
    pair, carrier = [], []
    for at, i in enumerate(joint):
        for j in joint[at + 1 :]:
            common = np.flatnonzero(touches[:, i] & touches[:, j])
            if len(common) or meets[i, j]:
                pair.append((i, j))
                carrier.append(int(common[0]) if len(common) else -1)
    return np.array(pair, np.int64).reshape(-1, 2), np.array(carrier, np.int64)


def variation(X: Floats, pair: Ints) -> Floats:
    """(bone,) standard deviation over the frames of the length of each bone, mesh unit.

    X : (frame, area, xyz) where the joints are; NaN in frames in which they are not seen
    """
    length = np.linalg.norm(X[:, pair[:, 0]] - X[:, pair[:, 1]], axis=2)
    return np.array([np.std(row[np.isfinite(row)]) if np.isfinite(row).any() else np.inf for row in length.T])


def without_redundant(X: Floats, pair: Ints) -> Ints:
    """The bones of the minimum spanning tree on length variation, ascending (Sec. 6.3.2)."""
    return spanning(pair, variation(X, pair), X.shape[1])
