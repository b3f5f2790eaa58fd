"""Geodesic distance over a triangle mesh from many sources (2014, Eq. 1: g), by virtual sources in Dijkstra's order.

Around each source distances are exact (`light`). Beyond, a triangle is unfolded when two of its vertices have their
distance (`unfolding`), and every edge is a path, so that a distance exists wherever there is a connection, and paths may
bend at saddles and borders. Distances do not depend on any number of threads. Beyond the exact ones they are
approximate: by default, over bodies of 5,000 to 20,000 vertices, 0.1 to 0.2 % from the exact ones in the mean and 0.8 to
1.3 % at one vertex in a thousand (2.2 % on a coarse animal); at the worst 2 %, on two of the bodies 3 and 4 %, where two
fronts meet and lend each other a source. The exact part takes most of the time: with 12 edges of it, a quarter of the time
and up to 4 % (6 % on a rough surface); with none, a fifth and up to 10 %.
"""

import numpy as np
import numpy.typing as npt

from kinetree.pipeline.errors import MeshError
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.front import Topology, propagate, topology, workspace
from kinetree.tasks.numerics.surface import Surface

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

EXACT = 28.0  # mean edges: beyond them, what `unfolding` errs by is less than 2 % of the distance on the bodies tried


def geodesic_distance(surface: Surface, source: npt.ArrayLike, radius: float = np.inf, exact: float = EXACT) -> Floats:
    """Distance g(s, v) over the surface from each source vertex on its own.

    surface : a mesh prepared once for all its sources
    source  : (source,) vertex numbers of the input mesh
    radius  : mesh unit; propagation stops there
    exact   : mean edges around each source in which distances are exact; infinite for the whole surface, at eighty
              times the time of 12,000 vertices. Near edges of three faces or of opposite ones nothing is exact
    returns : (source, vertex) mesh unit; infinite in other components, in vertices without a face, beyond `radius`
    raises  : MeshError if there is no source, or one is not a vertex of the mesh
    """
    return fields(topology(surface), checked_sources(surface, source), surface.order, surface.edge, radius, exact)


def checked_sources(surface: Surface, source: npt.ArrayLike) -> Ints:
    """Input vertex numbers as an array in the surface's own numbering.

    source  : (source,) vertex numbers of the input mesh
    returns : (source,)
    raises  : MeshError if there is no source, or one is not a vertex of the mesh
    """
    asked = np.atleast_1d(np.asarray(source))
    if asked.size == 0:
        raise MeshError("distances from no source were asked for; name at least one vertex")
    if asked.dtype.kind not in "iu":
        raise MeshError(f"sources are vertex numbers, but these are of type {asked.dtype}; pass integers")
    vertices = len(surface.order)
    wrong = np.flatnonzero((asked < 0) | (asked >= vertices))
    if wrong.size:
        at = int(wrong[0])
        raise MeshError(
            f"source {at} is vertex {asked[at]}, but the mesh has {vertices} vertices; number them from 0 to {vertices - 1}"
        )
    rank = np.empty(vertices, np.int64)
    rank[surface.order] = np.arange(vertices)
    return rank[asked]


@compiled
def fields(mesh: Topology, source: Ints, order: Ints, edge: float, radius: float, exact: float) -> Floats:
    """Distances (source, vertex) in the input's numbering from sources in the surface's own, in one compiled call."""
    vertices = len(order)
    out = np.empty((len(source), vertices))
    room = workspace(vertices, len(mesh[1]))
    for s in range(len(source)):
        propagate(mesh, np.uint64(source[s]), edge, radius, room, exact)
        for i in range(vertices):
            out[s, order[i]] = room[0][i]
    return out
