"""Laws of persistence: pairs counted another way, loops of surfaces whose handles are known."""

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from kinetree.tasks.numerics.topology.persistence import loop_counts, loop_spans, neighbours, region_above, superlevel_peaks


def strip(values):
    """A path of triangles: the values along one side, and far lower ones on the other."""
    n = len(values)
    F = [[i, i + 1, n + i] for i in range(n - 1)] + [[i + 1, n + i + 1, n + i] for i in range(n - 1)]
    return np.concatenate([values, np.linspace(-10.0, -11.0, n)]), np.array(F)


def sheet(rows, columns):
    """A flat rectangle of triangles."""
    i = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = i[:-1, :-1].ravel(), i[:-1, 1:].ravel(), i[1:, 1:].ravel(), i[1:, :-1].ravel()
    return np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])


def torus(major=2.0, minor=0.5):
    ring = trimesh.creation.torus(major_radius=major, minor_radius=minor, major_sections=96, minor_sections=48)
    return np.array(ring.vertices), np.array(ring.faces)


def components_above(f, F, level):
    inside = f >= level
    E = np.concatenate([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]])
    E = E[inside[E].all(axis=1)]
    label = connected_components(coo_matrix((np.ones(len(E)), (E[:, 0], E[:, 1])), shape=(len(f), len(f))))[1]
    return len(np.unique(label[inside]))


def test_peaks_of_a_path_end_where_they_meet_a_higher_one():
    f, F = strip(np.array([0.0, 5.0, 1.0, 3.0, 2.0, 9.0, 0.5]))
    peaks = superlevel_peaks(f, F)
    assert peaks.vertex.tolist() == [5, 1, 3]
    assert peaks.persistence.tolist() == [9.0 - f.min(), 4.0, 1.0]
    assert peaks.saddle.tolist() == [-1, 2, 4]
    assert peaks.into.tolist() == [-1, 0, 0]


def test_only_peaks_of_the_asked_persistence_are_returned():
    f, F = strip(np.array([0.0, 5.0, 1.0, 3.0, 2.0, 9.0, 0.5]))
    assert superlevel_peaks(f, F, least=1.5).vertex.tolist() == [5, 1]
    assert superlevel_peaks(f, F, least=4.0).vertex.tolist() == [5, 1]


@settings(deadline=None, max_examples=40)
@given(seed=st.integers(0, 10_000), levels=st.integers(2, 30))
def test_births_less_deaths_are_the_components_of_every_superlevel_set(seed, levels):
    F = sheet(7, 9)
    f = np.random.default_rng(seed).integers(0, levels, 63).astype(float)
    peaks = superlevel_peaks(f, F)
    death = f[peaks.vertex] - peaks.persistence
    ended = peaks.saddle >= 0
    for level in np.unique(f)[1:]:
        alive = (f[peaks.vertex] >= level).sum() - (death[ended] >= level).sum()
        assert alive == components_above(f, F, level)


@settings(deadline=None, max_examples=25)
@given(seed=st.integers(0, 10_000))
def test_peaks_follow_a_renumbering_of_the_vertices(seed):
    rng = np.random.default_rng(seed)
    F, f = sheet(8, 8), rng.random(64)
    order = rng.permutation(64)
    moved = np.empty(64)
    moved[order] = f
    before, after = superlevel_peaks(f, F), superlevel_peaks(moved, order[F])
    np.testing.assert_array_equal(order[before.vertex], after.vertex)
    np.testing.assert_array_equal(before.persistence, after.persistence)


@settings(deadline=None, max_examples=25)
@given(seed=st.integers(0, 10_000))
def test_noise_moves_no_persistence_by_more_than_twice_its_size(seed):
    rng = np.random.default_rng(seed)
    F, f = sheet(9, 9), rng.random(81)
    noisy = superlevel_peaks(f + rng.uniform(-0.02, 0.02, 81), F).persistence
    clean = superlevel_peaks(f, F).persistence
    longest = max(len(clean), len(noisy))
    difference = np.pad(clean, (0, longest - len(clean))) - np.pad(noisy, (0, longest - len(noisy)))
    assert np.abs(difference).max() <= 0.04


def test_a_constant_function_has_neither_peaks_nor_loops():
    V, F = torus()
    assert len(superlevel_peaks(np.ones(len(V)), F).vertex) == 0
    assert not loop_counts(np.ones(len(V)), F).any()


def test_every_component_has_a_highest_peak_and_stray_vertices_none():
    f, F = strip(np.array([0.0, 2.0, 1.0]))
    two = np.concatenate([F, F + 6])
    peaks = superlevel_peaks(np.concatenate([f, f + 3.0, [99.0]]), two)
    assert peaks.vertex.tolist() == [1, 7]
    assert peaks.saddle.tolist() == [-1, -1]


@pytest.mark.parametrize("noise", [0.0, 0.01])
def test_a_sphere_has_no_loop_however_rough_the_function(noise):
    ball = trimesh.creation.icosphere(subdivisions=4)
    f = np.array(ball.vertices)[:, 2] + np.random.default_rng(3).normal(0.0, noise, len(ball.vertices))
    assert not loop_counts(f, np.array(ball.faces)).any()


def test_the_hole_of_a_torus_is_one_loop_as_long_as_the_hole():
    V, F = torus()
    spans = loop_spans(loop_counts(V[:, 0], F))
    assert spans.shape == (1,)
    assert spans[0] == pytest.approx(2 * (2.0 - 0.5) / (2 * (2.0 + 0.5)), abs=0.01)


def test_noise_shifts_a_loop_by_no_more_than_its_size():
    V, F = torus()
    noisy = V[:, 0] + np.random.default_rng(4).uniform(-0.02, 0.02, len(V))
    assert loop_spans(loop_counts(noisy, F))[0] == pytest.approx(0.6, abs=0.04)


def test_two_holes_side_by_side_are_two_loops_at_the_same_levels():
    V, F = torus()
    second = V + np.array([0.0, 0.0, 8.0])
    both, faces = np.concatenate([V, second]), np.concatenate([F, F + len(V)])
    assert loop_counts(both[:, 0], faces).max() == 2
    np.testing.assert_allclose(loop_spans(loop_counts(both[:, 0], faces)), [0.6, 0.6], atol=0.01)


def test_a_hole_in_a_sheet_is_a_loop_as_long_as_the_hole():
    F = sheet(41, 41)
    x, y = np.meshgrid(np.arange(41.0), np.arange(41.0))
    inside = ((np.abs(x - 20) < 8) & (np.abs(y - 20) < 8)).ravel()
    open_faces = F[~inside[F].any(axis=1)]
    spans = loop_spans(loop_counts(x.ravel(), open_faces))
    assert spans.shape == (1,)
    assert spans[0] == pytest.approx(16 / 40, abs=0.03)


def test_spans_count_stacked_runs_of_levels():
    np.testing.assert_allclose(loop_spans(np.array([0, 1, 2, 1, 0, 1, 0, 0, 0, 0])), [0.3, 0.1, 0.1])
    assert loop_spans(np.zeros(5, dtype=np.int64)).size == 0


def test_a_region_above_a_level_is_what_the_seed_is_connected_to():
    f, F = strip(np.array([0.0, 5.0, 1.0, 3.0, 2.0, 9.0, 0.5]))
    assert sorted(region_above(f, 1.5, 5, *neighbours(F, len(f)))) == [3, 4, 5]
    assert sorted(region_above(f, 9.5, 5, *neighbours(F, len(f)))) == [5]
