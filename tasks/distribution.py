"""How μ is distributed over one frame's surface."""

from kinetree.pipeline.task import task
from kinetree.schemas.distribution import Distribution, DistributionParams
from kinetree.schemas.geodesics import Geodesics
from kinetree.tasks.numerics.correlation import dimensionless, summary


@task(over="frame")
def distribution(geodesics: Geodesics, params: DistributionParams) -> Distribution:
    """Summarises the distribution of μ on one frame, so that frames meet as histograms (2014, Sec. 4)."""
    inside = geodesics.area > 0
    mu, area = geodesics.mu[inside], geodesics.area[inside]
    told = summary(dimensionless(mu, area), area) if params.normalisation == "sequence" else summary(mu)
    return Distribution(normalisation=params.normalisation, low=told.low, high=told.high, mass=told.mass)
