"""μ on one frame: how far every point of the body is from all the rest of it, along the surface."""

import numpy as np
from numpy.typing import NDArray

from kinetree.errors import MeshError
from kinetree.pipeline.task import task
from kinetree.schemas.array import Floats
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.topology.geodesics import Geodesics, GeodesicsParams
from kinetree.tasks.numerics.geometry.components import largest_component
from kinetree.tasks.numerics.geometry.surface import Surface
from kinetree.tasks.numerics.topology.geodesics import farthest_bases, mu, mu_from_every_vertex


@task(over="frame")
def geodesics(mesh: Mesh, params: GeodesicsParams) -> Geodesics:
    """Integrates geodesic distance over one frame's largest component, μ (2014, Sec. 4, Eq. 1)."""
    inside, F, share = largest_component(mesh.vertices, mesh.faces)
    if share < params.least_share:
        raise MeshError(
            f"the largest component has {share:.0%} of the surface's area, {params.least_share:.0%} are needed for one body;"
            " join the pieces, or lower geodesics.least_share"
        )
    surface = Surface.of(mesh.vertices[inside], F)
    if params.sum == "vertices":
        integral, bases = mu_from_every_vertex(surface), np.empty(0, np.int64)
    else:
        spread = farthest_bases(surface, params.bases)
        integral, bases = mu(spread.distance, spread.weight), inside[spread.vertex]
    return Geodesics(
        mu=_scattered(integral, inside, len(mesh.vertices), np.nan),
        area=_scattered(surface.area, inside, len(mesh.vertices), 0.0),
        bases=bases,
        share=share,
    )


def _scattered(values: Floats, inside: NDArray[np.int64], count: int, rest: float) -> Floats:
    """Values of the kept vertices among all vertices, `rest` elsewhere."""
    whole = np.full(count, rest)
    whole[inside] = values
    return whole
