"""How μ is distributed over one frame's surface."""

from kinetree.pipeline.task import task
from kinetree.schemas.topology.geodesics import Geodesics
from kinetree.schemas.topology.mu_histogram import MuHistogram, MuHistogramParams
from kinetree.tasks.numerics.topology.mu_histogram import dimensionless, summary


@task(over="frame")
def mu_histogram(geodesics: Geodesics, params: MuHistogramParams) -> MuHistogram:
    """Summarises the distribution of μ on one frame, so that frames meet as histograms (2014, Sec. 4)."""
    inside = geodesics.area > 0
    mu, area = geodesics.mu[inside], geodesics.area[inside]
    of_frame = summary(dimensionless(mu, area), area) if params.normalisation == "sequence" else summary(mu)
    return MuHistogram(normalisation=params.normalisation, low=of_frame.low, high=of_frame.high, mass=of_frame.mass)
