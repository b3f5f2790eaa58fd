"""Annuli around a leaf, and the cone that they grow into (2014, Sec. 6.1.1.1; Figs. 4 and 7)."""

import numpy as np
import numpy.typing as npt
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Bools = npt.NDArray[np.bool_]

ANNULI = 25
"""Annuli in the longest distance from a leaf (Sec. 6.1.1.1, footnote 1)."""
SLIVER = 0.1
"""What has less than this share of a band's greatest piece was cut off by the edges, not by the body's shape."""


def edges(F: Ints) -> Ints:
    """(edge, 2) every edge of the faces once, the smaller vertex first."""
    code = np.sort(F[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    return np.unique(code, axis=0).astype(np.int64)


def bands(distance: Floats, annuli: int = ANNULI) -> Ints:
    """B^k: the k with distance in [δk, δ(k + 1)), δ the greatest distance over the number of annuli.

    distance : (vertex,) from a leaf, mesh unit; NaN where there is no way
    returns  : (vertex,) 0 around the leaf, −1 where there is no way
    """
    known = np.isfinite(distance)
    band = np.full(len(distance), -1)
    far = float(distance[known].max(initial=0.0))
    if far > 0.0:
        band[known] = np.minimum((distance[known] * (annuli / far)).astype(np.int64), annuli - 1)
    return band


def grown(band: Ints, seed: Bools, area: Floats, E: Ints) -> Ints:
    """Adds the next adjacent band until it is disjoint.

    band    : (vertex,) see `bands`; −1 is never grown into
    seed    : (vertex,) where to begin: the pieces of the lowest band among them
    area    : (vertex,) mesh unit²
    E       : (edge, 2)
    returns : (vertex,) annulus of every vertex, −1 beyond the cone
    """
    out = np.full(len(band), -1)
    seed = seed & (band >= 0)
    if not seed.any():
        return out
    k = int(band[seed].min())
    piece = pieces(band == k, E)
    mine = np.isin(piece, piece[seed & (band == k)])
    while True:
        out[mine] = k
        piece = pieces(band == k + 1, E)
        near = np.unique(piece[reached(mine, E) & (band == k + 1)])
        if len(_great(near, piece, area)) != 1:
            return out
        mine, k = np.isin(piece, near), k + 1


def reached(inside: Bools, E: Ints) -> Bools:
    """(vertex,) the ends of all edges that begin inside.

    inside : (vertex,), E : (edge, 2)
    """
    out = np.zeros(len(inside), dtype=bool)
    out[E[inside[E].any(axis=1)]] = True
    return out


def _great(near: Ints, piece: Ints, area: Floats) -> Ints:
    """The pieces that are no slivers beside the greatest."""
    size = np.array([area[piece == p].sum() for p in near])
    return near[size >= SLIVER * size.max(initial=0.0)] if len(near) else near


def pieces(inside: Bools, E: Ints) -> Ints:
    """(vertex,) number of the connected piece of each vertex inside, −1 outside.

    inside : (vertex,), E : (edge, 2)
    """
    held = E[inside[E].all(axis=1)]
    links = coo_array((np.ones(len(held), bool), (held[:, 0], held[:, 1])), shape=(len(inside), len(inside)))
    piece = connected_components(links, directed=False)[1].astype(np.int64)
    return np.where(inside, piece, -1)
