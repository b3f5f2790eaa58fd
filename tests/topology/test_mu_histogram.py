"""The distribution of μ on one frame, as the task gives it."""

import numpy as np
import pytest

from kinetree.schemas.topology.geodesics import Geodesics
from kinetree.schemas.topology.mu_histogram import MuHistogramParams
from kinetree.tasks.topology.mu_histogram import mu_histogram


def geodesics_of(mu: list[float], area: list[float]) -> Geodesics:
    return Geodesics(mu=np.array(mu), area=np.array(area), bases=np.array([0]), share=1.0)


def test_default_counts_area_and_the_letter_counts_vertices() -> None:
    surface = geodesics_of([1.0, 2.0, 3.0], [6.0, 1.0, 1.0])
    assert mu_histogram(surface, MuHistogramParams()).mass[[0, -1]].tolist() == [0.75, 0.125]
    letter = mu_histogram(surface, MuHistogramParams(normalisation="frame"))
    assert letter.mass[[0, -1]] == pytest.approx([1 / 3, 1 / 3])
    assert (letter.low, letter.high) == (1.0, 3.0)


def test_default_does_not_change_with_scale() -> None:
    here = mu_histogram(geodesics_of([1.0, 2.0, 3.0], [6.0, 1.0, 1.0]), MuHistogramParams())
    larger = mu_histogram(geodesics_of([8.0, 16.0, 24.0], [24.0, 4.0, 4.0]), MuHistogramParams())
    assert (larger.low, larger.high) == pytest.approx((here.low, here.high))
    assert np.array_equal(larger.mass, here.mass)


def test_what_floats_beside_the_body_is_not_counted() -> None:
    alone = mu_histogram(geodesics_of([1.0, 3.0], [1.0, 1.0]), MuHistogramParams())
    with_debris = mu_histogram(geodesics_of([1.0, np.nan, 3.0], [1.0, 0.0, 1.0]), MuHistogramParams())
    assert with_debris == alone
