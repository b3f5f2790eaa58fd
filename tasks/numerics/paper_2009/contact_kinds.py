"""How parts of the body touch: end to end, end to side, side to side (2009, Sec. 2.6)."""

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from kinetree.tasks.numerics.arrays import Floats, Ints

END_TO_END, END_TO_SIDE, SIDE_TO_SIDE = 1, 2, 3
"""The paper's three types, in its order."""


class ContactSettings(NamedTuple):
    """When branches touch."""

    gap: float = 0.01
    """Distance between two surfaces below which they touch, share of the root of the area. Not recorded."""
    apart: float = 0.1
    """Distance at rest from which on two points that meet are a contact, share of the root of the area. Not recorded."""
    end: float = 0.2
    """Share of a branch, from its leaf, that is its end. Not recorded."""


def contacts(
    rest: Floats,
    x: Floats,
    label: Ints,
    branch: Ints,
    share: Floats,
    size: float,
    settings: ContactSettings | None = None,
) -> Ints:
    """(contact, 3) pairs of branches that touch, the trunk being −1, and how.

    rest, x : (vertex, xyz) the surface at rest · as posed, mesh unit
    label : (vertex,) node that carries it
    branch : (node,) leaf at the end of its branch, −1 on the trunk
    share  : (node,) distance from that leaf by the length of the branch
    size   : root of the area, mesh unit
    """
    chosen = settings or ContactSettings()
    of_vertex = branch[label]
    kinds: dict[tuple[int, int], int] = {}
    names = [int(b) for b in np.unique(of_vertex)]
    points = {b: np.flatnonzero(of_vertex == b) for b in names}
    for i, b in enumerate(names):
        for a in names[:i]:
            tree = cKDTree(x[points[a]])
            distance, nearest = tree.query(x[points[b]], distance_upper_bound=chosen.gap * size)
            hit = np.isfinite(distance)
            u, v = points[a][nearest[hit]], points[b][hit]
            one, other = label[u], label[v]
            far = np.linalg.norm(rest[u] - rest[v], axis=1) > chosen.apart * size
            if far.any():
                ends = [bool(k >= 0 and (share[n[far]] < chosen.end).mean() > 0.5) for k, n in ((a, one), (b, other))]
                kinds[a, b] = {0: SIDE_TO_SIDE, 1: END_TO_SIDE, 2: END_TO_END}[sum(ends)]
    rows = [(a, b, kind) for (a, b), kind in sorted(kinds.items())]
    return np.array(rows, np.int64).reshape(-1, 3)


def branch_shares(node: Floats, parents: Ints, branch: Ints, end: Ints) -> Floats:
    """(node,) distance of each node from its branch's leaf, by the branch's length; 1 on the trunk."""
    out = np.ones(len(node))
    for leaf, n in enumerate(end.tolist()):
        way = [n]
        while branch[way[-1]] == leaf and parents[way[-1]] >= 0:
            way.append(int(parents[way[-1]]))
        far = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(node[way], axis=0), axis=1))])
        for k, m in enumerate(way):
            if branch[m] == leaf:
                out[m] = far[k] / max(float(far[-1]), np.finfo(float).tiny)
    return out
