"""Farthest-point sampling over a surface: each next point is the one farthest from all before it (after Hilaga 2001)."""

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.geometry.bucketed_dijkstra import propagate, workspace
from kinetree.tasks.numerics.geometry.geodesic_graph import Links
from kinetree.tasks.numerics.geometry.surface import Surface


def farthest_points(surface: Surface, spacing: Floats, count: int) -> Ints:
    """Farthest-point sampling in units of the local spacing.

    surface : any number of components; each gets a point before any gets its second
    spacing : (vertex,) wanted, up to a factor
    count   : points wanted; all vertices if there are fewer
    returns : (point,) vertices of the input mesh, ascending
    """
    return np.sort(_sampled(surface, spacing, count, 0)[0])


def farthest_points_with_fields(surface: Surface, count: int) -> tuple[Ints, Floats, Ints]:
    """Farthest-point sampling that keeps the distances by which the points were chosen.

    surface : one component
    count   : points wanted; all vertices if there are fewer
    returns : (point,) vertices of the input mesh in the order of choice: any first few are well spread too ·
              (point, vertex) geodesic distance from each, mesh unit · (vertex,) the point nearest to each vertex
    """
    return _sampled(surface, np.ones(len(surface.order)), count, count)


def _sampled(surface: Surface, spacing: Floats, count: int, fields: int) -> tuple[Ints, Floats, Ints]:
    """Begins at the vertex farthest, in space, from the surface's centre of area; keeps so many fields."""
    first = int(np.argmax(((surface.position - surface.centre) ** 2).sum(axis=1)))
    rank, vertices = np.argsort(surface.order), len(surface.order)
    distance = np.empty((min(fields, vertices), vertices))
    return _farthest(surface.links, rank, surface.order, surface.edge, spacing, first, min(count, vertices), distance)


@compiled
def _farthest(
    mesh: Links, rank: Ints, order: Ints, edge: float, spacing: Floats, first: int, count: int, distance: Floats
) -> tuple[Ints, Floats, Ints]:
    """Points in the order of choice, `distance` as written, nearest point of each vertex; all in the input's numbering.

    Where `distance` has no rows, fronts stop at the largest gap: what lies beyond it cannot become nearer.
    """
    vertices = len(order)
    chosen, cell = np.empty(count, np.int64), np.zeros(vertices, np.int64)
    nearest = np.full(vertices, np.inf)
    work = workspace(vertices, len(mesh[1]))
    base, gap = first, np.inf
    for b in range(count):
        chosen[b] = base
        propagate(mesh, np.uint64(rank[base]), edge, np.inf if len(distance) else gap, work)
        for i in range(vertices):
            v, d = order[i], work[0][i]
            if len(distance):
                distance[b, v] = d
            if d < nearest[v]:
                nearest[v], cell[v] = d, b
        base, gap = 0, 0.0
        for v in range(vertices):
            if nearest[v] / spacing[v] > nearest[base] / spacing[base]:
                base = v
            gap = max(gap, nearest[v])
    return chosen, distance, cell
