"""Laws of a prepared surface: areas, centre, and which half-edges are neighbours."""

import numpy as np
import shapes

from kinetree.tasks.numerics.geometry.surface import BORDER, NON_MANIFOLD, Surface, surface_areas


def test_vertex_areas_sum_to_the_area_of_the_surface() -> None:
    V, F = shapes.open_cylinder(24, 9, radius=0.5, height=3.0)
    assert np.isclose(Surface.of(V, F).area.sum(), 24 * 2 * 0.5 * np.sin(np.pi / 24) * 3.0)


def test_areas_alone_are_those_of_the_surface_to_the_last_bit() -> None:
    V, F = shapes.sphere(2)
    F = np.where(np.arange(len(F))[:, None] % 3, F, F[:, [0, 2, 1]])  # every third face is turned over
    V = V + np.random.default_rng(0).normal(0.0, 0.01, V.shape)
    assert surface_areas(V, F).tobytes() == Surface.of(V, F).area.tobytes()


def test_the_centre_of_area_is_the_middle_of_a_symmetric_body_however_it_is_meshed() -> None:
    V, F = shapes.sphere(2)
    split = F[V[F].mean(axis=1)[:, 2] > 0]
    number = len(V) + np.arange(len(split))
    finer = np.concatenate([np.stack([split[:, k], split[:, (k + 1) % 3], number], axis=1) for k in range(3)])
    rest = F[V[F].mean(axis=1)[:, 2] <= 0]
    W = np.concatenate([V, V[split].mean(axis=1)])
    assert np.allclose(Surface.of(V + 5.0, F).centre, 5.0)
    assert np.allclose(Surface.of(W + 5.0, np.concatenate([rest, finer])).centre, 5.0, atol=1e-3)


def test_a_twin_of_a_twin_is_the_half_edge_itself() -> None:
    surface = Surface.of(*shapes.sphere(2))
    twin = surface.twin.astype(np.int64)
    assert np.array_equal(twin[twin], np.arange(len(twin)))


def test_only_borders_lack_a_twin_on_an_orientable_surface() -> None:
    surface = Surface.of(*shapes.open_cylinder(24, 9))
    assert (surface.twin == BORDER).sum() == 2 * 24


def test_an_edge_of_three_faces_pairs_none_of_them() -> None:
    V, F, _ = shapes.three_pages(4, 6)
    twin = Surface.of(V, F).twin
    assert (twin == NON_MANIFOLD).sum() == 3 * 5
    assert (twin == BORDER).sum() == 3 * (2 * 3 + 5)


def test_every_edge_is_in_the_rings_of_both_its_ends() -> None:
    for V, F in (shapes.sphere(2), shapes.open_cylinder(12, 5), shapes.three_pages(4, 6)[:2]):
        surface = Surface.of(V, F)
        owner = np.repeat(np.arange(len(V)), np.diff(surface.ring_start.astype(np.int64)))
        pairs = {(int(surface.order[a]), int(surface.order[b])) for a, b in zip(owner, surface.ring >> 1, strict=True)}
        sides = F[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
        assert pairs == {(int(a), int(b)) for a, b in sides} | {(int(b), int(a)) for a, b in sides}
