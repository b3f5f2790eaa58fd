"""The distribution of μ on one frame, as the task gives it."""

import numpy as np
import pytest

from kinetree.schemas.distribution import DistributionParams
from kinetree.schemas.geodesics import Geodesics
from kinetree.tasks.distribution import distribution


def found(mu: list[float], area: list[float]) -> Geodesics:
    return Geodesics(mu=np.array(mu), area=np.array(area), bases=np.array([0]), share=1.0)


def test_default_counts_area_and_the_letter_counts_vertices() -> None:
    seen = found([1.0, 2.0, 3.0], [6.0, 1.0, 1.0])
    assert distribution(seen, DistributionParams()).mass[[0, -1]].tolist() == [0.75, 0.125]
    letter = distribution(seen, DistributionParams(normalisation="frame"))
    assert letter.mass[[0, -1]] == pytest.approx([1 / 3, 1 / 3])
    assert (letter.low, letter.high) == (1.0, 3.0)


def test_default_does_not_change_with_scale() -> None:
    here = distribution(found([1.0, 2.0, 3.0], [6.0, 1.0, 1.0]), DistributionParams())
    larger = distribution(found([8.0, 16.0, 24.0], [24.0, 4.0, 4.0]), DistributionParams())
    assert (larger.low, larger.high) == pytest.approx((here.low, here.high))
    assert np.array_equal(larger.mass, here.mass)


def test_what_floats_beside_the_body_is_not_counted() -> None:
    alone = distribution(found([1.0, 3.0], [1.0, 1.0]), DistributionParams())
    with_debris = distribution(found([1.0, np.nan, 3.0], [1.0, 0.0, 1.0]), DistributionParams())
    assert with_debris == alone
