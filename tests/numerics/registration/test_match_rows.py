"""Matches that count, one by one, against the same formulas over whole arrays."""

import numpy as np

from kinetree.tasks.numerics.registration.match_rows import MatchRows, match_rows, residuals, row_energies

REACH, SCALE, SHARE = 0.8, 0.3, 0.01


def _unit(N):
    return N / np.linalg.norm(N, axis=1, keepdims=True)


def _matches():
    rng = np.random.default_rng(5)
    x, V = rng.normal(size=(40, 3)), rng.normal(size=(50, 3))
    n, N = _unit(rng.normal(size=(40, 3))), _unit(rng.normal(size=(50, 3)))
    vertex, other = rng.integers(40, size=4000), rng.integers(50, size=4000)
    return (x, n, V, N), vertex, other


def test_a_match_counts_where_it_is_near_and_both_normals_agree():
    (x, n, V, N), vertex, other = _matches()
    rows = MatchRows(*match_rows(x, n, V, N, vertex, other, REACH, SCALE, SHARE))
    r, alike = x[vertex] - V[other], (n[vertex] * N[other]).sum(axis=1)
    counts = (np.linalg.norm(r, axis=1) < REACH) & (alike > 0.5)
    assert 20 < counts.sum() < 2000
    np.testing.assert_array_equal(rows.vertex, vertex[counts])
    np.testing.assert_array_equal(rows.other, other[counts])
    np.testing.assert_array_equal(rows.residual, r[counts])
    np.testing.assert_array_equal(residuals(x, rows.vertex, V, rows.other), rows.residual)


def test_planes_lie_halfway_between_both_normals_and_far_ones_weigh_less():
    (x, n, V, N), vertex, other = _matches()
    rows = MatchRows(*match_rows(x, n, V, N, vertex, other, REACH, SCALE, SHARE))
    halfway = _unit(n[rows.vertex] + N[rows.other])
    off = (rows.residual * halfway).sum(axis=1)
    alike = (n[rows.vertex] * N[rows.other]).sum(axis=1)
    np.testing.assert_allclose(rows.normal, halfway, atol=1e-14)
    np.testing.assert_allclose(rows.plane, SHARE * alike / (1 + (off / SCALE) ** 2) ** 2, rtol=1e-12)


def test_normals_that_cancel_leave_no_match_that_is_not_a_number():
    x, n = np.zeros((1, 3)), np.array([[0.0, 0.0, 1.0]])
    rows = MatchRows(*match_rows(x, n, x, -n, np.zeros(1, int), np.zeros(1, int), REACH, SCALE, SHARE))
    assert [len(column) for column in rows] == [0] * 5


def test_energies_are_those_of_the_plane_and_of_the_distance():
    (x, n, V, N), vertex, other = _matches()
    rows = MatchRows(*match_rows(x, n, V, N, vertex, other, REACH, SCALE, SHARE))
    nearness = np.linspace(0.0, 1.0, len(rows.plane))
    plane, distance = row_energies(rows.residual, rows.normal, rows.plane, nearness)
    np.testing.assert_allclose(plane, rows.plane * (rows.residual * rows.normal).sum(axis=1) ** 2, rtol=1e-12)
    np.testing.assert_allclose(distance, nearness * (rows.residual**2).sum(axis=1), rtol=1e-12)
