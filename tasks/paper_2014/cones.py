"""The cones of one interval."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.paper_2014.cones import Cones, ConesParams
from kinetree.schemas.paper_2014.interval_reference import IntervalReference
from kinetree.schemas.topology.geodesics import Geodesics
from kinetree.tasks.numerics.paper_2014 import cones as numerics


@task(over="interval")
def cones(interval_reference: IntervalReference, geodesics: Mapping[int, Geodesics], params: ConesParams) -> Cones:
    """Grows a cone of annuli from every leaf until the next band is disjoint (2014, Sec. 6.1.1.1; Fig. 7)."""
    reference = interval_reference
    mu, F = geodesics[reference.frame].mu, reference.faces.astype(np.int64)
    leaf_vertex = reference.leaf_vertex.astype(np.int64)
    grown = numerics.cones(reference.coordinates, leaf_vertex, mu, reference.area, F, params.annuli)
    return Cones(annuli=params.annuli, annulus=grown.annulus, mu_range=grown.mu_range)
