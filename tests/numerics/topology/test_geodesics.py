"""Laws of μ and of the bases that it is summed over."""

from itertools import pairwise

import numpy as np
import pytest
import shapes

from kinetree.errors import DisconnectedMeshError
from kinetree.tasks.numerics.geometry.geodesic_distance import geodesic_distance
from kinetree.tasks.numerics.geometry.surface import Surface
from kinetree.tasks.numerics.topology.geodesics import farthest_bases, mu, mu_from_every_vertex


def from_bases(surface: Surface, count: int = 200) -> np.ndarray:
    bases = farthest_bases(surface, count)
    return mu(bases.distance, bases.weight)


def test_on_a_unit_sphere_mu_is_two_pi_squared_everywhere() -> None:
    # mean angle to a random point is π/2, area 4π
    mu = from_bases(Surface.of(*shapes.sphere(4)))
    assert np.abs(mu / (2 * np.pi**2) - 1).max() < 0.01


def test_two_hundred_bases_miss_the_sum_over_all_vertices_by_half_a_percent_at_most() -> None:
    surface = Surface.of(*shapes.y_pipe(arm=40, half_width=7)[:2])
    whole = mu_from_every_vertex(surface, surface.area)
    assert np.abs(from_bases(surface) / whole - 1).max() < 0.005


def test_as_many_bases_as_vertices_is_the_sum_over_all() -> None:
    surface = Surface.of(*shapes.flat_grid(7, 5))
    bases = farthest_bases(surface, 1000)
    assert sorted(bases.vertex) == list(range(35))
    assert np.allclose(mu(bases.distance, bases.weight), mu_from_every_vertex(surface, surface.area), rtol=1e-12)


def test_the_first_equation_counts_every_vertex_once() -> None:
    surface = Surface.of(*shapes.flat_grid(7, 5))
    rows = geodesic_distance(surface, np.arange(35))
    # lengths are float32
    assert np.allclose(mu_from_every_vertex(surface), rows.sum(axis=0), rtol=1e-6)


def test_cells_share_out_the_whole_area() -> None:
    surface = Surface.of(*shapes.y_pipe()[:2])
    bases = farthest_bases(surface, 50)
    assert np.isclose(bases.weight.sum(), surface.area.sum(), rtol=1e-12)
    assert np.all(bases.weight > 0)


def test_every_vertex_lies_in_the_cell_of_its_nearest_base() -> None:
    bases = farthest_bases(Surface.of(*shapes.y_pipe()[:2]), 50)
    nearest = bases.distance.min(axis=0)
    assert np.array_equal(bases.distance[bases.cell, np.arange(len(nearest))], nearest)


def test_bases_keep_apart_what_they_cover() -> None:
    bases = farthest_bases(Surface.of(*shapes.y_pipe()[:2]), 50)
    cover = bases.distance.min(axis=0).max()
    apart = bases.distance[:, bases.vertex] + np.diag(np.full(50, np.inf))
    assert apart.min() >= 0.95 * cover


def test_a_farther_base_is_never_chosen_after_a_nearer_one() -> None:
    bases = farthest_bases(Surface.of(*shapes.y_pipe()[:2]), 20)
    chosen_at = [bases.distance[:k, bases.vertex[k]].min() for k in range(1, 20)]
    assert all(later <= sooner for sooner, later in pairwise(chosen_at))


def test_mu_of_a_pipe_with_three_arms_is_greatest_at_their_tips_and_least_in_the_middle() -> None:
    V, F, _ = shapes.y_pipe()
    surface = Surface.of(V, F)
    mu = mu_from_every_vertex(surface, surface.area)
    tips = np.argsort(mu)[-3:]
    radius = np.linalg.norm(V[:, :2], axis=1)
    assert np.all(radius[tips] == radius.max())
    assert radius[np.argmin(mu)] == 0.0


def test_mu_is_the_same_on_each_of_three_equal_arms() -> None:
    V, F, onto = shapes.y_pipe()
    mu = mu_from_every_vertex(Surface.of(V, F))
    assert np.abs(mu[onto] / mu - 1).max() < 0.005


def test_the_bases_are_where_they_were_after_moving_scaling_and_renumbering() -> None:
    rng = np.random.default_rng(4)
    V, F, _ = shapes.y_pipe()
    V = V + rng.normal(scale=0.05, size=V.shape)
    Q = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    new = rng.permutation(len(V))
    W = np.empty_like(V)
    W[new] = 7.0 * (V @ (Q * np.linalg.det(Q)).T) + [1.0, 2.0, 300.0]
    here, there = farthest_bases(Surface.of(V, F), 12), farthest_bases(Surface.of(W, new[F]), 12)
    assert there.vertex[0] == new[here.vertex[0]]
    a, b = mu(here.distance, here.weight), mu(there.distance, there.weight)[new] / 7.0**3
    assert np.abs(a / b - 1).max() < 0.01


def test_a_finer_mesh_has_the_same_mu() -> None:
    coarse, fine = from_bases(Surface.of(*shapes.sphere(3))), from_bases(Surface.of(*shapes.sphere(4)))
    assert np.isclose(coarse.mean(), fine.mean(), rtol=0.02)


def test_two_components_have_no_mu() -> None:
    surface = Surface.of(*shapes.two_components())
    half = len(surface.order) // 2
    words = f"{half} of the mesh's {2 * half} vertices cannot be reached"
    with pytest.raises(DisconnectedMeshError, match=words):
        farthest_bases(surface)
    with pytest.raises(DisconnectedMeshError, match=words):
        mu_from_every_vertex(surface)
    with pytest.raises(DisconnectedMeshError, match=words):
        mu(geodesic_distance(surface, [0]), np.array([1.0]))
