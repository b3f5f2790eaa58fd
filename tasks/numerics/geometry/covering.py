"""Nodes spread over a surface at a spacing that varies, and the nearest nodes of every vertex, by geodesic distance."""

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.geometry.bucketed_dijkstra import Topology, propagate, topology, workspace
from kinetree.tasks.numerics.geometry.surface import Surface

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

_REACH = 5.0  # largest gaps between nodes, or edges of the mesh: a vertex's nine nearest nodes lie within


def covering(surface: Surface, spacing: Floats, count: int) -> Ints:
    """Farthest-point sampling in units of the local spacing.

    surface : any number of components; each gets a node before any gets its second
    spacing : (vertex,) wanted, up to a factor
    count   : nodes wanted
    returns : (node,) vertices of the input mesh, ascending
    """
    first = int(np.argmax(((surface.position - surface.centre) ** 2).sum(axis=1)))
    rank = np.argsort(surface.order)
    wanted = min(count, len(rank))
    return np.sort(_spread(topology(surface), rank, surface.order, surface.edge, spacing, first, wanted))


def nearest_nodes(surface: Surface, node: Ints, count: int) -> tuple[Ints, Floats]:
    """The nearest nodes of every vertex and their distances over the surface.

    node    : (node,) vertices of the input mesh
    count   : how many are wanted
    returns : (vertex, count) nodes, nearest first, −1 where no further one is in reach · (vertex, count) mesh unit
    """
    mesh, rank = topology(surface), np.argsort(surface.order)
    # where every vertex is a node there is no gap, and across a long edge the next node lies beyond the largest one
    gap = max(_largest_gap(mesh, rank, surface.order, surface.edge, node), float(surface.length.max(initial=0.0)))
    return _nearest(mesh, rank, surface.order, surface.edge, node, _REACH * gap, count)


@compiled
def _spread(mesh: Topology, rank: Ints, order: Ints, edge: float, spacing: Floats, first: int, count: int) -> Ints:
    """(node,) in the order of choice; what lies beyond the largest gap cannot become nearer, so fronts stop there."""
    vertices = len(order)
    chosen = np.empty(count, np.int64)
    nearest = np.full(vertices, np.inf)
    room = workspace(vertices, len(mesh[1]))
    base, reach = first, np.inf
    for b in range(count):
        chosen[b] = base
        propagate(mesh, np.uint64(rank[base]), edge, reach, room)
        for i in range(vertices):
            nearest[order[i]] = min(nearest[order[i]], room[0][i])
        base, reach = 0, 0.0
        for v in range(vertices):
            if nearest[v] / spacing[v] > nearest[base] / spacing[base]:
                base = v
            reach = max(reach, nearest[v])
    return chosen


@compiled
def _largest_gap(mesh: Topology, rank: Ints, order: Ints, edge: float, node: Ints) -> float:
    """Largest distance of a vertex to its nearest node; components without a node do not count."""
    nearest = np.full(len(order), np.inf)
    room = workspace(len(order), len(mesh[1]))
    for b in range(len(node)):
        propagate(mesh, np.uint64(rank[node[b]]), edge, nearest.max(), room)
        for i in range(len(order)):
            nearest[i] = min(nearest[i], room[0][i])
    gap = 0.0
    for i in range(len(order)):
        if nearest[i] < np.inf:
            gap = max(gap, nearest[i])
    return gap


@compiled
def _nearest(
    mesh: Topology, rank: Ints, order: Ints, edge: float, node: Ints, reach: float, count: int
) -> tuple[Ints, Floats]:
    nearest = np.full((len(order), count), -1, np.int64)
    distance = np.full((len(order), count), np.inf)
    room = workspace(len(order), len(mesh[1]))
    for b in range(len(node)):
        propagate(mesh, np.uint64(rank[node[b]]), edge, reach, room)
        for i in range(len(order)):
            d, v = room[0][i], order[i]
            k = count
            while k > 0 and distance[v, k - 1] > d:
                k -= 1
                if k + 1 < count:
                    distance[v, k + 1], nearest[v, k + 1] = distance[v, k], nearest[v, k]
            if k < count:
                distance[v, k], nearest[v, k] = d, b
    return nearest, distance
