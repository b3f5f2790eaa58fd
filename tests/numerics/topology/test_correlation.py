"""Laws of the correlation of μ's distribution between frames (2014, Eq. 2)."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinetree.tasks.numerics.topology.correlation import correlations, histograms
from kinetree.tasks.numerics.topology.mu_histogram import summary


def columns(summaries):
    return tuple(np.array(column) for column in zip(*summaries, strict=True))


def samples(seed, n=4000, shift=0.0):
    rng = np.random.default_rng(seed)
    return 0.5 + shift + 0.3 * rng.beta(2, 4, n), rng.random(n) + 0.1


def test_frame_histograms_are_those_of_the_vertices_themselves():
    x, _ = samples(2)
    H = histograms(*columns([summary(x)]), normalisation="frame")
    expected = np.histogram(x, bins=100)[0] / len(x)
    np.testing.assert_allclose(H[0], expected, atol=1.5 / len(x))


@settings(deadline=None, max_examples=25)
@given(seed=st.integers(0, 10_000))
def test_a_bin_misses_at_most_what_the_fine_bins_at_its_ends_hold(seed):
    frames = [samples(seed, 700), samples(seed + 1, 900, 0.1)]
    rows = [summary(x, w) for x, w in frames]
    H = histograms(*columns(rows), smoothing=0.0)
    edges = np.linspace(min(r.low for r in rows), max(r.high for r in rows), 101)
    for (x, w), row, h in zip(frames, rows, H, strict=True):
        exact = np.histogram(x, bins=edges, weights=w)[0] / w.sum()
        assert np.abs(h - exact).max() <= 2 * row.mass.max() + 1e-12


def test_histograms_sum_to_one_smoothed_or_not():
    rows = columns([summary(*samples(seed, shift=0.05 * seed)) for seed in range(4)])
    for settings_ in ({"smoothing": 0.0}, {"smoothing": 2.0}, {"normalisation": "frame"}):
        np.testing.assert_allclose(histograms(*rows, **settings_).sum(axis=1), 1.0)


def test_the_frame_normalisation_is_blind_to_a_change_of_range_and_the_sequence_is_not():
    x, weight = samples(5)
    rows = columns([summary(x, weight), summary(1.5 * x, weight)])
    assert correlations(histograms(*rows, normalisation="frame"))[0] == pytest.approx(1.0, abs=1e-6)
    assert correlations(histograms(*rows))[0] < 0.7


def test_equal_frames_correlate_fully():
    rows = columns([summary(*samples(6))] * 5)
    assert correlations(histograms(*rows)).tolist() == [1.0] * 4
    assert correlations(histograms(*rows, normalisation="frame")).tolist() == [1.0] * 4


@pytest.mark.parametrize("normalisation", ["sequence", "frame"])
@pytest.mark.parametrize("value", [0.0, 0.443])
def test_constant_values_have_a_histogram_and_correlate_fully(value, normalisation):
    H = histograms(*columns([summary(np.full(50, value))] * 3), normalisation=normalisation)
    np.testing.assert_allclose(H.sum(axis=1), 1.0)
    assert correlations(H).tolist() == [1.0, 1.0]


def test_a_sphere_whose_values_are_only_noise_does_not_change():
    rng = np.random.default_rng(7)
    rows = columns([summary(0.443 * (1 + rng.normal(0, 0.0005, 3000) + rng.normal(0, 0.001))) for _ in range(6)])
    assert correlations(histograms(*rows)).min() > 0.9


def test_flat_histograms_equal_each_other_and_nothing_else():
    flat, peaked = np.full(10, 0.1), np.eye(1, 10)[0]
    assert correlations(np.stack([flat, flat, peaked])).tolist() == [1.0, 0.0]


def test_correlation_is_pearsons():
    H = np.random.default_rng(8).random((4, 30))
    expected = [np.corrcoef(H[t], H[t + 1])[0, 1] for t in range(3)]
    np.testing.assert_allclose(correlations(H), expected, atol=1e-12)
    np.testing.assert_allclose(correlations(H, lag=2), [np.corrcoef(H[t], H[t + 2])[0, 1] for t in range(2)], atol=1e-12)


def test_one_frame_has_no_correlation():
    assert correlations(np.ones((1, 10))).shape == (0,)
    assert correlations(np.ones((2, 10)), lag=2).shape == (0,)
