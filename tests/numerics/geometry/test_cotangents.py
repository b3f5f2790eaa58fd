"""Laws of cotangent weights."""

import numpy as np
import pytest
from shapes import flat_grid, sphere, y_pipe

from kinetree.tasks.numerics.geometry.cotangents import cotangent_links


def applied(V, F, values):
    """(vertex,) Σ_j w_ij (u_i − u_j)."""
    links = cotangent_links(V, F)
    tail = np.repeat(np.arange(len(V)), np.diff(links.start))
    return np.bincount(tail, links.weight * (values[tail] - values[links.ring]), len(V))


def test_two_equilateral_triangles_weigh_one_by_root_three():
    V = np.array([[0, 0, 0], [1, 0, 0], [0.5, np.sqrt(0.75), 0], [0.5, -np.sqrt(0.75), 0]])
    links = cotangent_links(V, np.array([[0, 1, 2], [1, 0, 3]]))
    shared = links.weight[links.start[0] : links.start[1]][links.ring[links.start[0] : links.start[1]] == 1]
    assert shared == pytest.approx(1 / np.sqrt(3))
    assert links.weight.sum() == pytest.approx((2 + 4) / np.sqrt(3)), "a border has half"


def test_a_function_that_rises_evenly_over_a_plane_is_in_balance_inside_it():
    V, F = flat_grid(7, 6)
    inside = (V[:, 0] > 0) & (V[:, 0] < 6) & (V[:, 1] > 0) & (V[:, 1] < 5)
    # the weight of a square's diagonal is 0, and clamped to a little above it
    np.testing.assert_allclose(applied(V, F, V @ [2.0, -3.0, 0.0])[inside], 0.0, atol=1e-9)


def test_weights_do_not_change_with_size_place_or_order():
    V, F, _ = y_pipe(8, 2)
    plain = cotangent_links(V, F)
    np.testing.assert_allclose(cotangent_links(7.0 * V + 3.0, F[::-1]).weight, plain.weight, rtol=1e-9)
    tail = np.repeat(np.arange(len(V)), np.diff(plain.start))
    way = {(i, j): w for i, j, w in zip(tail, plain.ring, plain.weight, strict=True)}
    assert all(way[j, i] == pytest.approx(w) for (i, j), w in way.items())


def test_obtuse_and_thin_triangles_have_small_positive_weights():
    V, F = flat_grid(6, 6, shear=3.0)
    weight = cotangent_links(V, F).weight
    assert (weight > 0.0).all()
    V[F[0, 0]] = V[F[0, 1]]
    thin = cotangent_links(V, F).weight
    assert np.isfinite(thin).all()
    assert thin.max() <= 20.0


def test_round_ball_is_pulled_to_its_middle():
    V, F = sphere(3)
    pull = np.stack([applied(V, F, V[:, k]) for k in range(3)], axis=1)
    np.testing.assert_allclose(pull / np.linalg.norm(pull, axis=1, keepdims=True), V, atol=0.05)
