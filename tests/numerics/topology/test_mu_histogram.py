"""Laws of the distribution of μ over one frame."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from kinetree.tasks.numerics.topology.mu_histogram import Summary, dimensionless, summary


def samples(seed, n=4000, shift=0.0):
    rng = np.random.default_rng(seed)
    return 0.5 + shift + 0.3 * rng.beta(2, 4, n), rng.random(n) + 0.1


def test_mean_distance_on_a_sphere_is_a_quarter_turn_over_the_root_of_its_area():
    radius = 3.0
    area = np.full(10, 4 * np.pi * radius**2 / 10)
    mu = np.full(10, np.pi / 2 * radius * area.sum())
    np.testing.assert_allclose(dimensionless(mu, area), np.pi / 2 / np.sqrt(4 * np.pi))


def test_scale_does_not_change_the_dimensionless_integral():
    mu, area = samples(1)
    np.testing.assert_allclose(dimensionless(mu * 7.0**3, area * 7.0**2), dimensionless(mu, area), rtol=1e-12)


@settings(deadline=None, max_examples=25)
@given(seed=st.integers(0, 10_000))
def test_a_summary_does_not_depend_on_the_order_of_vertices(seed):
    x, weight = samples(seed, 200)
    order = np.random.default_rng(seed).permutation(200)
    one, other = summary(x, weight), summary(x[order], weight[order])
    assert one[:2] == other[:2]
    np.testing.assert_allclose(one.mass, other.mass, atol=1e-15)


def test_a_summary_of_one_value_holds_all_its_weight():
    row = summary(np.array([2.0]))
    assert isinstance(row, Summary)
    assert row.mass.sum() == 1.0
