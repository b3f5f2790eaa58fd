"""Laws of comparing colours and of the form that they add to a fit."""

import numpy as np
from limbs import tube
from painted import waves
from scipy.spatial import cKDTree
from shapes import sphere

from kinetree.tasks.numerics.registration.colour_term import (
    FrameColour,
    colour_forms,
    compared,
    feature_matches,
    gradient_of_noise,
    surface_gradient,
)
from kinetree.tasks.numerics.registration.correspondence import Target

ALL = np.arange(1000)


def points(seed: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Colours, and normals at rest and now, of a thousand points."""
    rng = np.random.default_rng(seed)
    rest, now = (n / np.linalg.norm(n, axis=1, keepdims=True) for n in rng.normal(size=(2, 1000, 3)))
    return rng.uniform(0.2, 0.8, (1000, 3)), rest, now


def test_exposure_and_light_of_one_side_are_explained() -> None:
    body, rest, now = points()
    lit = 0.8 * body + 0.05 + now @ np.full((3, 3), 0.07) - rest @ np.full((3, 3), 0.04)
    found = compared(FrameColour(lit, body), rest, now, ALL, ALL)
    assert found.share > 0.999999
    np.testing.assert_allclose(found.body, found.frame, atol=1e-6)


def test_a_tenth_of_wrong_matches_changes_little() -> None:
    body, rest, now = points()
    other = ALL.copy()
    other[::10] = other[::10][::-1]
    found = compared(FrameColour(0.7 * body, body), rest, now, ALL, other)
    right = np.setdiff1d(ALL, ALL[::10])
    np.testing.assert_allclose(found.body[right], found.frame[right], atol=0.002)


def test_light_on_plain_skin_is_no_agreement() -> None:
    _, rest, now = points()
    rng = np.random.default_rng(1)
    light = rng.normal(size=(3, 3)) * 0.1
    body, frame = (0.5 + n @ light + 0.01 * rng.normal(size=(1000, 3)) for n in (rest, now))
    assert compared(FrameColour(frame, body), rest, now, ALL, ALL).share < 0.05


def test_colours_of_another_body_do_not_agree() -> None:
    body, rest, now = points()
    assert compared(FrameColour(points(7)[0], body), rest, now, ALL, ALL).share < 0.05


def test_gradient_of_a_colour_that_is_linear_in_space_is_that_in_the_tangent_plane() -> None:
    V, F = tube(around=60, along=120)
    frame = Target.of(V, F, 7.0)
    slope = np.array([[0.1, 0, 0], [0, 0.2, 0], [0.1, 0.1, 0.3]])
    G = surface_gradient(V, frame.N, V @ slope.T, frame.start, frame.ring)
    expected = slope - np.einsum("kx,vx->vk", slope, frame.N)[:, :, None] * frame.N[:, None, :]
    middle = np.abs(V[:, 2]) < 3.0
    np.testing.assert_allclose(G[middle], expected[middle], atol=0.02)
    assert np.abs(np.einsum("vkx,vx->vk", G, frame.N)).max() < 1e-12


def test_a_walk_in_features_ends_where_a_search_of_all_vertices_does() -> None:
    V, F = tube()
    frame = Target.of(V, F, 7.0)
    Q = np.hstack([V, waves(V)])
    x, _ = tube(around=19, along=37, start=0.1)
    P = np.hstack([x, waves(x)])
    begun = cKDTree(V).query(x)[1]
    ended = feature_matches(P, begun, Q, frame.start, frame.ring)
    assert (ended == cKDTree(Q).query(P)[1]).mean() > 0.95


def test_form_is_the_square_of_what_colours_leave() -> None:
    rng = np.random.default_rng(0)
    r, wanted, G = rng.normal(size=(5, 3)), rng.normal(size=(5, 3)), rng.normal(size=(5, 3, 3))
    H, p, c = colour_forms(r, wanted, G, np.ones(5), 0.5, 1.0, 1e9, 1e9, 0.0)
    mine = np.einsum("rx,rxy,ry->r", r, H, r) - 2.0 * np.einsum("rx,rx->r", r, p) + c
    np.testing.assert_allclose(mine, 0.5 * ((np.einsum("rkx,rx->rk", G, r) - wanted) ** 2).sum(axis=1))


def test_flat_colours_hold_nothing_and_steep_ones_no_more_than_is_allowed() -> None:
    r = np.ones((1, 3))
    assert not colour_forms(r, r, np.zeros((1, 3, 3)), np.ones(1), 1.0, 1.0, 3.0, 1.0, 0.1)[0].any()
    steep = 1e3 * np.eye(3)[None]
    H = colour_forms(np.zeros((1, 3)), np.zeros((1, 3)), steep, np.ones(1), 1.0, 1.0, 3.0, 1.0, 0.0)[0]
    np.testing.assert_allclose(np.trace(H[0]), 1.0)


def test_a_gradient_that_noise_makes_holds_nothing() -> None:
    zero, one, G = np.zeros((1, 3)), np.ones(1), 0.1 * np.eye(3)[None]
    held = [colour_forms(zero, zero, G, one, 1.0, 1.0, 3.0, 9.0, chance)[0] for chance in (0.0, 0.015, 0.03)]
    assert [float(np.trace(H[0]).round(9)) for H in held] == [0.03, 0.015, 0.0]


def test_noise_of_vertices_is_known_by_the_gradient_that_it_makes() -> None:
    V, F = sphere(4)
    frame = Target.of(V, F, 3.5)
    colour = 0.02 * np.random.default_rng(0).normal(size=V.shape)
    made = (surface_gradient(V, frame.N, colour, frame.start, frame.ring) ** 2).sum(axis=(1, 2)).mean()
    np.testing.assert_allclose(gradient_of_noise(V, colour, frame.start, frame.ring), made, rtol=0.1)
    assert gradient_of_noise(V, 0.1 * V, frame.start, frame.ring) < 0.01 * 0.1**2
