"""Cones: the surface around a leaf up to where the body branches, in rings (2014, Sec. 6.1.1.1; Fig. 4)."""

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.compiled import compiled


def cones(distance: Floats, area: Floats, leaves: Ints, start: Ints, ring: Ints, rings: int = 50, pocket: float = 0.1) -> Ints:
    """Rings of equal geodesic width around every leaf, as far as what lies beyond is one branch.

    The paper stops where the next ring falls apart, which ends an arm at its fingers. Here (ours) a cone continues past side
    branches that have no leaf and less than `pocket` of the area: they are absorbed, ring by ring.

    distance    : (leaf, vertex) geodesic distance from each leaf, mesh unit; infinite where no path leads
    area        : (vertex,) mesh unit²
    leaves      : (leaf,) vertices
    start, ring : neighbours of every vertex, see `neighbours.rings`
    rings       : rings in the longest distance from each leaf
    pocket      : share of the area
    returns     : (leaf, vertex) ring of every vertex, 0 around the leaf, −1 beyond the cone
    """
    out = np.full(distance.shape, -1, np.int64)
    holds = np.zeros(len(area), np.bool_)
    holds[leaves] = True
    for k, d in enumerate(distance):
        reach = np.isfinite(d)
        far = float(d[reach].max())
        if far <= 0.0:
            continue
        others = holds.copy()
        others[leaves[k]] = False
        order = np.argsort(-np.where(reach, d, -1.0), kind="stable")[: int(reach.sum())]
        end = _parting(d, order, area, others, start, ring, pocket * float(area[reach].sum()))
        inside = reach & (d < end)
        out[k, inside] = np.minimum((d[inside] * (rings / far)).astype(np.int64), rings - 1)
    return out


@compiled
def _parting(d: Floats, order: Ints, area: Floats, leaf: Flags, start: Ints, ring: Ints, enough: float) -> float:
    """The smallest distance beyond which two branches lie apart, each with a leaf or of enough area; infinite if none.

    order : (vertex,) farthest first
    leaf  : (vertex,) whether it is one of the other leaves
    """
    parent = np.full(len(d), -1, np.int64)
    mass = area.copy()
    held = leaf.copy()
    end = np.inf
    for v in order:
        parent[v] = v
        own = v
        for q in range(start[v], start[v + 1]):
            if parent[ring[q]] < 0:
                continue
            other = ring[q]
            while parent[other] != other:
                parent[other] = parent[parent[other]]
                other = parent[other]
            if other == own:
                continue
            if (held[own] or mass[own] >= enough) and (held[other] or mass[other] >= enough):
                end = d[v]
            parent[other] = own
            mass[own] += mass[other]
            held[own] |= held[other]
    return end
