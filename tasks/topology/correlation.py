"""C(t): how alike successive frames are in the distribution of μ."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.topology.correlation import Correlation, CorrelationParams
from kinetree.schemas.topology.mu_histogram import MuHistogram
from kinetree.tasks.numerics.input.frame_numbers import take_spans
from kinetree.tasks.numerics.topology.correlation import correlations, histograms


@task(among=Sequence)
def correlation(distribution: Mapping[int, MuHistogram], params: CorrelationParams) -> Correlation:
    """Correlates the histograms of μ of successive frames (2014, Sec. 4, Eq. 2)."""
    mu_histogram = tuple(distribution.values())
    H = histograms(
        np.array([d.low for d in mu_histogram]),
        np.array([d.high for d in mu_histogram]),
        np.array([d.mass for d in mu_histogram]),
        mu_histogram[0].normalisation,
        params.bins,
        params.smoothing,
    )
    C = correlations(H)
    C[[span.start - 1 for span in take_spans(tuple(distribution))[1:]]] = 0.0  # frames of two takes are no transition
    return Correlation(histograms=H, correlation=C)
