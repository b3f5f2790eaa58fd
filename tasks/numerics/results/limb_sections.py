"""Middles of sections across a limb that was found in one piece, and what of its surface lies beyond them (ours).

A section holds the points of the limb from which the ways over the surface to both ends of its bone have one ratio, so that it
goes across a bent limb as it goes across a straight one.
"""

from collections.abc import Sequence

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components, dijkstra

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.geometry.normals import vertex_areas

BAND = 0.04
"""Half the width of a section, share of the way from end to end. Half and twice as much move a middle less than it errs."""
AROUND_END = 1.25
"""A limb that ends in no other part begins at the vertices nearest to its end, up to this multiple of the least distance."""
FEWEST = 10
"""Vertices that a section has, at least; where fewer lie there it is wider, but not wider than …"""
WIDEST = 0.15
"""… this."""


def way_along(V: Floats, F: Ints, part: Ints, parents: Sequence[int], rest: Floats, child: int) -> Floats:
    """How far along its limb every vertex of the bone's part lies, from 0 at the inner end to 1 at the outer.

    V, F    : (vertex, xyz) mesh unit, (face, corner), in the reference pose
    part    : (vertex,) joint that each vertex follows most
    parents : (joint,) −1 for the root
    rest    : (joint, xyz) in the reference pose
    child   : the joint at the outer end of the bone
    returns : (vertex,) NaN where a vertex is of another part, or cannot be reached from both ends
    """
    inner = parents[child]
    own = np.flatnonzero(part == inner)
    out = np.full(len(V), np.nan)
    if not len(own):
        return out
    beyond = np.isin(part, list(_below(parents, child)))
    one_way = _edges(F)
    edges = np.concatenate([one_way, one_way[:, ::-1]])
    leaving = edges[(part[edges[:, 0]] == inner) & (part[edges[:, 1]] != inner)]
    to_child = beyond[leaving[:, 1]]
    ends = [np.unique(leaving[~to_child, 0]), np.unique(leaving[to_child, 0])]
    ways = []
    for joint, border in zip((inner, child), ends, strict=True):
        away = np.linalg.norm(V - rest[joint], axis=1)
        start = border if len(border) else own[away[own] <= AROUND_END * away[own].min()]
        ways.append(_ways(V, edges, own, start, away[start]))
    total = ways[0] + ways[1]
    with np.errstate(invalid="ignore"):
        out[own] = np.where(np.isfinite(total) & (total > 0.0), ways[0] / total, np.nan)
    return out


def section_middle(V: Floats, F: Ints, way: Floats, share: float) -> Floats | None:
    """(xyz) the middle of the section at a share of the way along a limb; None where too few vertices lie there.

    way : (vertex,) as `way_along` gives it
    """
    off = np.abs(np.nan_to_num(way, nan=np.inf) - share)
    there = off <= np.clip(np.sort(off)[min(FEWEST, len(off)) - 1], BAND, WIDEST)
    if there.sum() < FEWEST:
        return None
    mass = vertex_areas(V, F)[there]
    return np.asarray(mass @ V[there] / mass.sum())


def share_beyond(V: Floats, F: Ints, joint: Floats, before: Floats, after: Floats) -> Floats:
    """(vertex,) 0 to 1: how much of each vertex lies beyond a joint, seen from its parent, in one piece with the outer end.

    The change from 0 to 1 is as wide as the surface around the joint, and smooth (3 s² − 2 s³).

    joint, before, after : (xyz) the joint, and the ends of the bones to both sides of it
    """
    axis = (joint - before) / _length(joint - before) + (after - joint) / _length(after - joint)
    along = (V - joint) @ (axis / _length(axis))
    away = np.linalg.norm(V - joint, axis=1)
    near = np.sort(away)[:FEWEST]
    half = float(np.median(near))
    rising = np.clip((along / max(half, 1e-300) + 1.0) / 2.0, 0.0, 1.0)
    edges = _edges(F)
    edges = edges[(rising[edges] > 0.0).all(axis=1)]
    graph = csr_array((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), shape=(len(V), len(V)))
    piece = connected_components(graph, directed=False)[1]
    reached: Flags = piece == piece[np.argmin(np.linalg.norm(V - after, axis=1))]
    return np.asarray(np.where(reached, rising**2 * (3.0 - 2.0 * rising), 0.0))


def _edges(F: Ints) -> Ints:
    """(edge, 2) the edges of all faces, one way round each face."""
    return np.concatenate([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]])


def _below(parents: Sequence[int], joint: int) -> set[int]:
    """A joint and all below it; parents come before children."""
    below = {joint}
    for j, p in enumerate(parents):
        if p in below:
            below.add(j)
    return below


def _ways(V: Floats, edges: Ints, own: Ints, start: Ints, first: Floats) -> Floats:
    """(own,) the least of first + the way along edges within the own vertices from a start."""
    number = np.full(len(V), -1)
    number[own] = np.arange(len(own))
    within = edges[(number[edges] >= 0).all(axis=1)]
    length = np.linalg.norm(V[within[:, 0]] - V[within[:, 1]], axis=1)
    rows = np.concatenate([number[within[:, 0]], np.full(len(start), len(own))])
    columns = np.concatenate([number[within[:, 1]], number[start]])
    weights = np.maximum(np.concatenate([length, first]), 1e-12)
    order = np.unique(np.stack([rows, columns], axis=1), axis=0, return_index=True)[1]
    graph = csr_array((weights[order], (rows[order], columns[order])), shape=(len(own) + 1,) * 2)
    return np.asarray(dijkstra(graph, indices=len(own))[:-1])


def _length(vector: Floats) -> float:
    return max(float(np.linalg.norm(vector)), 1e-300)
