"""C(t): how alike successive frames are in the distribution of μ."""

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.topology.correlation import Correlation, CorrelationParams
from kinetree.schemas.topology.mu_histogram import MuHistogram
from kinetree.tasks.numerics.topology.correlation import correlations, histograms


@task(among=Sequence)
def correlation(mu_histogram: tuple[MuHistogram, ...], params: CorrelationParams) -> Correlation:
    """Correlates the histograms of μ of successive frames (2014, Sec. 4, Eq. 2)."""
    H = histograms(
        np.array([d.low for d in mu_histogram]),
        np.array([d.high for d in mu_histogram]),
        np.array([d.mass for d in mu_histogram]),
        mu_histogram[0].normalisation,
        params.bins,
        params.smoothing,
    )
    return Correlation(histograms=H, correlation=correlations(H))
