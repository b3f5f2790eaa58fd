"""The undefined area, and the cylinders that define it one after another (2014, Sec. 6.2; Fig. 14)."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.paper_2014.cones import Bools, Floats, Ints, bands, edges, grown, pieces, reached

LEAST = 0.005
"""Undefined pieces with less than this share of the area are left to what lies around them."""

Cluster = Callable[[list[Ints]], Bools]
"""Tells of annuli, each the vertices of the reference in it, which belong to a rigid area, all intervals considered."""


class Piece(NamedTuple):
    """A kinematic cone or cylinder.

    limb  : whose leaf it starts from, cylinder : how many were found before it, −1 for a cone
    ring  : (vertex,) annulus, −1 outside
    rigid : (annulus,) from the lowest annulus there is to the highest
    """

    limb: int
    cylinder: int
    ring: Ints
    rigid: Bools


def trimmed(ring: Ints, rigid: Bools) -> list[Piece]:
    """Kinematic cones without the overlapping rigid area farthest from their leaves, and without other overlaps.

    What a cone's rigid area shares with another cone may be part of either, so all of that area is cut off (Sec. 6.2.2).
    The area around the leaf is kept as far as it overlaps with nothing.

    ring  : (limb, vertex) annulus, −1 beyond the cone
    rigid : (limb, annulus) as integrated over the intervals
    """
    out = []
    overlap = (ring >= 0).sum(axis=0) > 1
    cut = ring.copy()
    for n, row in enumerate(ring):
        last = int(row.max(initial=-1))
        first = last
        while first > 0 and rigid[n, first - 1] and rigid[n, last]:
            first -= 1
        if last >= 0 and first > 0 and rigid[n, last] and overlap[row >= first].any():
            cut[n, row >= first] = -1
    claimed = (cut >= 0).sum(axis=0)
    for n, row in enumerate(cut):
        mine = np.where(claimed == 1, row, -1)
        out.append(Piece(n, -1, mine, rigid[n, : int(mine.max(initial=-1)) + 1]))
    return out


def cylinders(cones: list[Piece], distance: Floats, area: Floats, F: Ints, cluster: Cluster, annuli: int) -> list[Piece]:
    """Takes the extension with the widest range of distances, clusters it, cuts it off, until nothing can be extended.

    cones    : of every limb
    distance : (limb, vertex) from the limb's leaf, mesh unit; NaN for a limb whose leaf is not seen in the reference
    area     : (vertex,) mesh unit²; F : (face, corner)
    annuli   : in the longest distance from a leaf
    returns  : the cylinders, in the order in which they were found
    """
    E = edges(F)
    band = [bands(d, annuli) for d in distance]
    limb_of = np.full(len(area), -1)
    for piece in cones:
        limb_of[piece.ring >= 0] = piece.limb
    found: list[Piece] = []
    while True:
        bare = pieces(limb_of == -1, E)
        small = np.bincount(bare[bare >= 0], area[bare >= 0], len(area)) < LEAST * area.sum()
        limb_of[(bare >= 0) & small[bare]] = -2
        best: tuple[float, int, Ints] | None = None
        for n, b in enumerate(band):
            ring = _extension(np.where(limb_of == -1, b, -1), limb_of == n, area, E)
            inside = ring >= 0
            if inside.any():
                wide = float(np.ptp(distance[n][inside]))
                if best is None or wide > best[0]:
                    best = (wide, n, ring)
        if best is None:
            break
        _, n, ring = best
        used = np.unique(ring[ring >= 0])
        ring = np.where(ring >= 0, np.searchsorted(used, ring), -1)
        rigid = cluster([np.flatnonzero(ring == k) for k in range(len(used))])
        found.append(Piece(n, len(found), ring, rigid))
        limb_of[ring >= 0] = n
    return found


def _extension(band: Ints, mine: Bools, area: Floats, E: Ints) -> Ints:
    """(vertex,) annuli of the undefined area that continue what a limb has, −1 elsewhere."""
    return grown(band, reached(mine, E) & ~mine, area, E)
