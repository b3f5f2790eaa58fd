"""C(t), as the task gives it."""

import numpy as np
import pytest

from kinetree.schemas.topology.correlation import CorrelationParams
from kinetree.schemas.topology.mu_histogram import MuHistogram
from kinetree.tasks.numerics.input.frame_numbers import TAKE
from kinetree.tasks.topology.correlation import correlation


def peaked(at: int, normalisation: str = "sequence") -> MuHistogram:
    return MuHistogram(normalisation=normalisation, low=0.0, high=1.0, mass=np.eye(2000)[at])


@pytest.mark.parametrize("normalisation", ["sequence", "frame"])
def test_equal_frames_correlate_fully_and_others_less(normalisation: str) -> None:
    series = correlation(dict(enumerate(peaked(at, normalisation) for at in (500, 500, 1500))), CorrelationParams())
    assert series.correlation[0] == 1
    assert series.correlation[1] < 0.1
    assert series.histograms.shape == (3, 100)
    assert series.histograms.sum(axis=1) == pytest.approx(np.ones(3))


def test_spheres_whose_mu_is_constant_correlate_fully() -> None:
    ball = MuHistogram(normalisation="sequence", low=0.443, high=0.443, mass=np.eye(2000)[0])
    assert correlation({0: ball, 1: ball}, CorrelationParams()).correlation.tolist() == [1.0]


def test_frames_of_two_takes_are_no_transition() -> None:
    series = correlation({t: peaked(500, "sequence") for t in (3, 4, TAKE, TAKE + 1)}, CorrelationParams())
    assert series.correlation.tolist() == [1.0, 0.0, 1.0]
