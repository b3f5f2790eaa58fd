"""The extrema of μ on one frame, and what of its topology motion does not change."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.topology.extrema import Extrema, ExtremaParams
from kinetree.schemas.topology.geodesics import Geodesics
from kinetree.tasks.numerics.geometry.normals import vertex_normals
from kinetree.tasks.numerics.topology import extrema as numerics
from kinetree.tasks.numerics.topology.mu_histogram import dimensionless


@task(over="frame")
def extrema(mesh: Mesh, geodesics: Geodesics, params: ExtremaParams) -> Extrema:
    """Finds the local maxima of μ that persist, and how far loops reach (2014, Sec. 5.1)."""
    inside = ~np.isnan(geodesics.mu)
    F = mesh.faces[inside[mesh.faces].all(axis=1)]
    mu, area = np.where(inside, geodesics.mu, 0.0), geodesics.area
    maxima = numerics.extrema(mu, F, params.threshold, params.roundness)
    none = np.zeros(0)
    peaks, loops = numerics.peaks_and_loops(mu, F) if len(maxima.vertex) else (none, none)
    return Extrema(
        vertices=maxima.vertex,
        persistence=maxima.persistence,
        stems=numerics.stems(mesh.vertices, F, mu, area, maxima, params.stations),
        normals=vertex_normals(mesh.vertices, F)[maxima.vertex],
        value=dimensionless(mu, area)[maxima.vertex],
        peaks=peaks,
        loops=loops,
        size=float(np.sqrt(area.sum())),
        centre=tuple((area @ mesh.vertices / area.sum()).tolist()),
        euler=mesh.cleaning.euler,
        components=mesh.cleaning.components_kept,
    )
