"""The tips of one frame, and what of its topology motion does not change."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.topology.extrema import Extrema, ExtremaParams
from kinetree.schemas.topology.geodesics import Geodesics
from kinetree.tasks.numerics.geometry.normals import smoothed_normals
from kinetree.tasks.numerics.topology.extrema import extrema as maxima_of_mu
from kinetree.tasks.numerics.topology.extrema import stems
from kinetree.tasks.numerics.topology.mu_histogram import dimensionless
from kinetree.tasks.numerics.topology.persistence import loop_counts, loop_spans, superlevel_peaks

LEAST_PEAK = 0.02
"""Share of the range of μ below which a maximum is noise whatever it is compared with."""


@task(over="frame")
def extrema(mesh: Mesh, geodesics: Geodesics, params: ExtremaParams) -> Extrema:
    """Finds the local maxima of μ that persist, and how far loops reach (2014, Sec. 5.1)."""
    inside = ~np.isnan(geodesics.mu)
    F = mesh.faces[inside[mesh.faces].all(axis=1)]
    mu = np.where(inside, geodesics.mu, 0.0)
    found = maxima_of_mu(mu, F, params.threshold, params.roundness)
    span = float(np.ptp(mu[inside]))
    peaks = superlevel_peaks(mu, F, LEAST_PEAK * span).persistence / span if len(found.vertex) else np.zeros(0)
    area = geodesics.area
    return Extrema(
        vertices=found.vertex,
        persistence=found.persistence,
        stems=stems(mesh.vertices, F, mu, area, found, params.stations),
        normals=smoothed_normals(mesh.vertices, F, rounds=0)[found.vertex],
        value=dimensionless(mu, area)[found.vertex],
        peaks=np.sort(peaks)[::-1],
        loops=loop_spans(loop_counts(mu, F)) if len(found.vertex) else np.zeros(0),
        size=float(np.sqrt(area.sum())),
        centre=tuple((area @ mesh.vertices / area.sum()).tolist()),
        euler=mesh.cleaning.euler,
        components=mesh.cleaning.components_kept,
    )
