"""Laws of leaves and stems, on balls with bumps and on tubes."""

import numpy as np
import pytest
import shapes
import trimesh

from kinetree.tasks.numerics.geometry.surface import Surface
from kinetree.tasks.numerics.topology.extrema import extrema, stems
from kinetree.tasks.numerics.topology.geodesics import farthest_bases
from kinetree.tasks.numerics.topology.geodesics import mu as mu_of

DIRECTIONS = np.array([[0.0, 0.0, 1.0], [0.9, 0.1, -0.42], [-0.6, 0.7, -0.39], [-0.2, -0.9, -0.38]])
DIRECTIONS /= np.linalg.norm(DIRECTIONS, axis=1, keepdims=True)


def integral(V, F):
    """μ as it is computed, and the area of every vertex."""
    surface = Surface.of(V, F)
    bases = farthest_bases(surface, 60)
    return mu_of(bases.distance, bases.weight), surface.area


def star(arms):
    """A ball of radius 1 with arms of the given lengths; the distance from its centre stands for μ."""
    ball = trimesh.creation.icosphere(subdivisions=5)
    unit, F = np.array(ball.vertices), np.array(ball.faces)
    lift = sum(a * np.exp(-40.0 * (1.0 - unit @ d)) for a, d in zip(arms, DIRECTIONS, strict=False))
    return unit * (1.0 + lift)[:, None], F, 1.0 + lift


def tube(length=2.0, radius=0.1, rings=201, sides=16):
    """An open tube along z, around the origin; |z| stands for μ, tilted a little so that its rims have one tip each."""
    z, angle = np.meshgrid(np.linspace(-length / 2, length / 2, rings), 2 * np.pi * np.arange(sides) / sides, indexing="ij")
    V = np.stack([radius * np.cos(angle), radius * np.sin(angle), z], axis=-1).reshape(-1, 3)
    i = np.arange(rings * sides).reshape(rings, sides)
    a, b = i[:-1], i[1:]
    a2, b2 = np.roll(a, -1, axis=1), np.roll(b, -1, axis=1)
    F = np.concatenate([np.stack([a, a2, b2], -1).reshape(-1, 3), np.stack([a, b2, b], -1).reshape(-1, 3)])
    return V, F, np.abs(V[:, 2]) + 1e-4 * V[:, 0]


def test_every_arm_has_one_leaf_at_its_tip_as_persistent_as_it_is_long():
    V, F, mu = star([1.0, 0.8, 0.5])
    peaks = extrema(mu, F)
    tips = V[peaks.vertex] / np.linalg.norm(V[peaks.vertex], axis=1, keepdims=True)
    np.testing.assert_allclose(tips, DIRECTIONS[:3], atol=0.05)
    np.testing.assert_allclose(peaks.persistence, [1.0, 0.8, 0.5], atol=0.02)


def test_the_threshold_is_a_share_of_the_bodys_own_range():
    _, F, mu = star([1.0, 0.8, 0.3, 0.08])
    assert len(extrema(mu, F).vertex) == 3
    assert len(extrema(mu, F, threshold=0.05).vertex) == 4
    assert len(extrema(mu, F, threshold=0.5).vertex) == 2


@pytest.mark.parametrize("noise", [0.0, 0.002])
def test_a_ball_has_no_leaves(noise):
    V, F, mu = star([0.0])
    rough = mu + np.random.default_rng(1).normal(0.0, noise, len(mu))
    peaks = extrema(rough, F)
    assert peaks.vertex.shape == peaks.persistence.shape == peaks.level.shape == (0,)
    assert stems(V, F, rough, np.ones(len(V)), peaks).shape == (0, 5, 3)


def test_a_mesh_without_faces_has_no_leaves():
    assert len(extrema(np.array([1.0, 2.0]), np.zeros((0, 3), dtype=np.int64)).vertex) == 0


def test_noise_below_the_threshold_adds_no_leaf_and_loses_none():
    V, F, mu = star([1.0, 0.8, 0.5])
    rough = mu + np.random.default_rng(2).uniform(-0.03, 0.03, len(mu))
    peaks = extrema(rough, F)
    assert len(peaks.vertex) == 3
    assert np.linalg.norm(V[peaks.vertex] - V[extrema(mu, F).vertex], axis=1).max() < 0.25


def test_leaves_follow_a_renumbering_and_do_not_see_the_unit():
    _, F, mu = star([1.0, 0.8, 0.5])
    order = np.random.default_rng(3).permutation(len(mu))
    moved = np.empty(len(mu))
    moved[order] = 1000.0 * mu
    before, after = extrema(mu, F), extrema(moved, order[F])
    np.testing.assert_array_equal(order[before.vertex], after.vertex)
    np.testing.assert_allclose(before.persistence, after.persistence, atol=1e-12)


def test_the_level_of_a_limb_is_where_the_first_other_limb_joins_it():
    V, F, mu = tube()
    peaks = extrema(mu, F)
    assert sorted(np.sign(V[peaks.vertex, 2]).tolist()) == [-1.0, 1.0]
    np.testing.assert_allclose(peaks.level, 0.0, atol=1e-3)


def test_stations_of_a_tube_lie_on_its_axis_at_even_steps():
    V, F, mu = tube()
    peaks = extrema(mu, F)
    S = stems(V, F, mu, np.ones(len(V)), peaks)
    side = np.sign(V[peaks.vertex, 2])[:, None]
    np.testing.assert_allclose(side * S[:, :-1, 2], [[0.125, 0.375, 0.625, 0.875]] * 2, atol=0.01)
    np.testing.assert_allclose(S[:, :-1, :2], 0.0, atol=0.01)
    np.testing.assert_array_equal(S[:, -1], V[peaks.vertex])


def test_stems_move_with_the_body():
    V, F, mu = star([1.0, 0.8, 0.5])
    peaks, area = extrema(mu, F), np.ones(len(V))
    R = trimesh.transformations.random_rotation_matrix(np.array([0.2, 0.5, 0.8]))[:3, :3]
    moved = stems(V @ R.T + [3.0, -1.0, 2.0], F, mu, area, peaks)
    np.testing.assert_allclose(moved, stems(V, F, mu, area, peaks) @ R.T + [3.0, -1.0, 2.0], atol=1e-9)


def test_a_band_without_area_stands_at_the_next_one_towards_the_tip():
    V, F, mu = tube(rings=4)
    S = stems(V, F, mu, np.ones(len(V)), extrema(mu, F), stations=9)
    assert np.isfinite(S).all()
    assert (np.diff(np.abs(S[:, :, 2]), axis=1) >= -1e-9).all()


def test_values_of_vertices_without_a_face_mean_nothing():
    V, F, mu = star([1.0, 0.8, 0.5])
    more, area = np.append(mu, np.nan), np.append(np.ones(len(V)), 0.0)
    peaks, expected = extrema(more, F), extrema(mu, F)
    for one, other in zip(peaks, expected, strict=True):
        np.testing.assert_array_equal(one, other)
    wide = np.vstack([V, np.zeros(3)])
    np.testing.assert_array_equal(stems(wide, F, more, area, peaks), stems(V, F, mu, np.ones(len(V)), expected))


def test_the_three_arms_of_a_pipe_have_three_equal_leaves_at_their_ends():
    V, F, turned = shapes.y_pipe()
    mu, _ = integral(V, F)
    peaks = extrema(mu, F)
    assert len(peaks.vertex) == 3
    np.testing.assert_allclose(mu[peaks.vertex], mu.max(), rtol=0.005)
    # the arms join at the edge of the middle, a little above the smallest μ, to which only the first one reaches down
    np.testing.assert_allclose(peaks.level, peaks.level[0], rtol=0.005)
    np.testing.assert_allclose(peaks.persistence[1:], peaks.persistence[1], atol=0.01)
    assert peaks.persistence[1] > 0.9
    reach = np.linalg.norm(V[peaks.vertex], axis=1)
    assert reach.min() > 0.9 * np.linalg.norm(V, axis=1).max()
    carried = V[turned[peaks.vertex]]
    nearest = np.linalg.norm(carried[:, None] - V[peaks.vertex][None], axis=2).argmin(axis=1)
    assert sorted(nearest.tolist()) == [0, 1, 2]
    assert (nearest != np.arange(3)).all()


def test_stations_climb_from_the_middle_of_a_pipe_to_its_ends():
    V, F, _ = shapes.y_pipe()
    mu, area = integral(V, F)
    peaks = extrema(mu, F)
    S = stems(V, F, mu, area, peaks)
    assert (np.diff(np.linalg.norm(S, axis=2), axis=1) > 0).all()
    direction = V[peaks.vertex] / np.linalg.norm(V[peaks.vertex], axis=1, keepdims=True)
    assert (np.einsum("lsk,lk->ls", S, direction) / np.linalg.norm(S, axis=2) > 0.9).all()


def test_a_measured_sphere_has_no_leaves():
    V, F = shapes.sphere()
    assert len(extrema(integral(V, F)[0], F).vertex) == 0
