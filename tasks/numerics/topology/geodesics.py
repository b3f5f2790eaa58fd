"""The integral of geodesic distance μ over a surface (2014, Eq. 1), from a few well-spread bases or from every vertex."""

from dataclasses import dataclass

import numpy as np

from kinetree.errors import DisconnectedMeshError
from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.geometry.bucketed_dijkstra import propagate, workspace
from kinetree.tasks.numerics.geometry.geodesic_graph import Links
from kinetree.tasks.numerics.geometry.sampling import farthest_points_with_fields
from kinetree.tasks.numerics.geometry.surface import Surface


@dataclass(frozen=True)
class Bases:
    """Vertices spread evenly over a surface, and the fields they were found by.

    vertex   : (base,) vertex numbers of the input mesh, in the order of choice: any first few are well spread too
    distance : (base, vertex) geodesic distance from each base, mesh unit; not exact around it, which μ would not feel
    cell     : (vertex,) the base nearest to each vertex
    weight   : (base,) area of each base's cell, mesh unit², summing to the surface's area
    """

    vertex: Ints
    distance: Floats
    cell: Ints
    weight: Floats


def farthest_bases(surface: Surface, count: int = 200) -> Bases:
    """Farthest-point bases with the area of their Voronoi cells (after Hilaga 2001 and 2014, Eq. 1).

    The first is the vertex farthest, in space, from the surface's centre of area; each next one the vertex farthest,
    over the surface, from all before it. Both choices follow rigid motion, scale and renumbering, ties excepted.

    surface : one component
    count   : bases wanted, at least 1; as many as there are vertices if that is fewer
    returns : Bases; the first field found every next base and is kept, so that μ costs no further propagation
    raises  : DisconnectedMeshError if a vertex cannot be reached from the first base
    """
    vertex, distance, cell = farthest_points_with_fields(surface, count)
    _refuse_infinite(distance[0], int(vertex[0]))
    weight = np.bincount(cell, surface.area, len(vertex)).astype(np.float64)
    return Bases(vertex, distance, cell, weight)


def mu(distance: Floats, weight: Floats) -> Floats:
    """Integral of geodesic distance over the surface, μ(v) = Σ_b w_b g(b, v)  (2014, Eq. 1; bases b after Hilaga 2001).

    distance : (base, vertex) in the mesh's unit
    weight   : (base,) area each base stands for, mesh unit², summing to the surface's area
    returns  : (vertex,) mesh unit³
    raises   : DisconnectedMeshError if any distance is infinite
    """
    for base in np.flatnonzero(np.isinf(distance).any(axis=1))[:1]:
        _refuse_infinite(distance[base], int(base))
    return _weighted_sum(np.ascontiguousarray(distance), np.ascontiguousarray(weight))


def mu_from_every_vertex(surface: Surface, weight: Floats | None = None) -> Floats:
    """The sum over all vertices, μ(v) = Σ_u w_u g(u, v), without ever holding all distances  (2014, Eq. 1).

    surface : one component
    weight  : (vertex,) what each vertex counts; 1 each if not given, which is Eq. 1 to the letter
    returns : (vertex,) mesh unit times the unit of weight; Eq. 1 to the letter grows with the number of vertices
    raises  : DisconnectedMeshError if a vertex cannot be reached
    """
    counted = np.ones(len(surface.order)) if weight is None else np.ascontiguousarray(weight, np.float64)
    total, unreached, source = _streamed_sum(surface.links, surface.order, surface.edge, counted)
    if unreached:
        raise DisconnectedMeshError(_disconnected(unreached, len(total), source))
    return total


def _refuse_infinite(distance: Floats, source: int) -> None:
    unreached = int(np.isinf(distance).sum())
    if unreached:
        raise DisconnectedMeshError(_disconnected(unreached, len(distance), source))


def _disconnected(unreached: int, vertices: int, source: int) -> str:
    return (
        f"{unreached} of the mesh's {vertices} vertices cannot be reached over its surface from source {source}, so μ "
        "has no value; keep one component, join the components, or drop vertices that no face uses"
    )


@compiled
def _weighted_sum(distance: Floats, weight: Floats) -> Floats:
    """Row by row in a fixed order: a library's product may split the sum by its number of threads."""
    total = np.zeros(distance.shape[1])
    for b in range(distance.shape[0]):
        for v in range(distance.shape[1]):
            total[v] += weight[b] * distance[b, v]
    return total


@compiled
def _streamed_sum(mesh: Links, order: Ints, edge: float, weight: Floats) -> tuple[Floats, int, int]:
    """Σ_u w_u g(u, ·) and, if some vertex is out of reach, how many are and from which source."""
    vertices = len(order)
    total = np.zeros(vertices)
    work = workspace(vertices, len(mesh[1]))
    for s in range(vertices):
        propagate(mesh, np.uint64(s), edge, np.inf, work)
        unreached = 0
        for i in range(vertices):
            total[order[i]] += weight[order[s]] * work[0][i]
            unreached += np.isinf(work[0][i])
        if unreached:
            return total, unreached, order[s]
    return total, 0, 0
