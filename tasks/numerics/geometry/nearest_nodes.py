"""The nearest nodes of every vertex of a surface, by geodesic distance."""

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.geometry.bucketed_dijkstra import propagate, workspace
from kinetree.tasks.numerics.geometry.geodesic_graph import Links
from kinetree.tasks.numerics.geometry.surface import Surface

_REACH = 5.0
"""Largest gaps between nodes, or edges of the mesh, within which a vertex's nine nearest nodes lie."""
_GOLDEN = (np.sqrt(5.0) - 1.0) / 2.0
"""Steps of this length around a circle divide it ever more evenly."""


def nearest_nodes(surface: Surface, node: Ints, count: int) -> tuple[Ints, Floats]:
    """The nearest nodes of every vertex and their distances over the surface.

    node    : (node,) vertices of the input mesh
    count   : how many are wanted
    returns : (vertex, count) nodes, nearest first, −1 where no further one is in reach · (vertex, count) mesh unit
    """
    mesh, rank = surface.links, np.argsort(surface.order)
    # where every vertex is a node there is no gap, and across a long edge the next node lies beyond the largest one
    gap = max(_largest_gap(mesh, rank, surface.order, surface.edge, _interleaved(node)), float(surface.length.max(initial=0.0)))
    return _nearest(mesh, rank, surface.order, surface.edge, node, _REACH * gap, count)


def _interleaved(node: Ints) -> Ints:
    """The nodes in an order of which any first few lie all over the list: gaps, and with them fronts, soon are small."""
    return node[np.argsort(np.arange(len(node)) * _GOLDEN % 1.0)]


@compiled
def _largest_gap(mesh: Links, rank: Ints, order: Ints, edge: float, node: Ints) -> float:
    """Largest distance of a vertex to its nearest node; components without a node do not count."""
    nearest = np.full(len(order), np.inf)
    work = workspace(len(order), len(mesh[1]))
    for b in range(len(node)):
        propagate(mesh, np.uint64(rank[node[b]]), edge, nearest.max(), work)
        for i in range(len(order)):
            nearest[i] = min(nearest[i], work[0][i])
    gap = 0.0
    for i in range(len(order)):
        if nearest[i] < np.inf:
            gap = max(gap, nearest[i])
    return gap


@compiled
def _nearest(mesh: Links, rank: Ints, order: Ints, edge: float, node: Ints, reach: float, count: int) -> tuple[Ints, Floats]:
    nearest = np.full((len(order), count), -1, np.int64)
    distance = np.full((len(order), count), np.inf)
    work = workspace(len(order), len(mesh[1]))
    for b in range(len(node)):
        propagate(mesh, np.uint64(rank[node[b]]), edge, reach, work)
        for i in range(len(order)):
            d, v = work[0][i], order[i]
            k = count
            while k > 0 and distance[v, k - 1] > d:
                k -= 1
                if k + 1 < count:
                    distance[v, k + 1], nearest[v, k + 1] = distance[v, k], nearest[v, k]
            if k < count:
                distance[v, k], nearest[v, k] = d, b
    return nearest, distance
