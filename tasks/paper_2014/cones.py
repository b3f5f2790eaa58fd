"""The cones of one interval."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.paper_2014.cones import Cones, ConesParams
from kinetree.schemas.paper_2014.interval_reference import IntervalReference
from kinetree.schemas.topology.geodesics import Geodesics
from kinetree.tasks.numerics.paper_2014.cones import bands, edges, grown


@task(over="interval")
def cones(middle: IntervalReference, geodesics: Mapping[int, Geodesics], params: ConesParams) -> Cones:
    """Grows a cone of annuli from every leaf until the next band is disjoint (2014, Sec. 6.1.1.1; Fig. 7)."""
    mu = geodesics[middle.frame].mu
    E = edges(middle.faces.astype(np.int64))
    ring = np.full(middle.distance.shape, -1)
    span = np.zeros(len(ring))
    for n, tip in enumerate(middle.tip):
        if tip < 0:
            continue
        seed = np.arange(len(mu)) == tip
        ring[n] = grown(bands(middle.distance[n], params.annuli), seed, middle.area, E)
        inside = (ring[n] >= 0) & np.isfinite(mu)
        span[n] = np.ptp(mu[inside]) if inside.any() else 0.0
    return Cones(annuli=params.annuli, ring=ring, span=span)
