"""Rings about surfaces whose girths are known."""

import numpy as np
import pytest
from bottles import revolution
from shapes import two_components

from kinetree.tasks.numerics.geometry.girths import girths


def test_girths_of_a_cone_grow_with_the_distance_from_its_tip() -> None:
    V, F = revolution([0.0, 10.0], [0.1, 2.1])
    rings = girths(V, F, V[:, 2], 0.5)
    inside = (rings.level > 0.3) & (rings.level < 9.5)
    np.testing.assert_allclose(rings.level, 0.5 * np.arange(len(rings.level)), atol=1e-12)
    np.testing.assert_allclose(rings.girth[inside], 2.0 * np.pi * (0.1 + 0.2 * rings.level[inside]), rtol=0.01)
    np.testing.assert_allclose(rings.centre[inside, :2], 0.0, atol=1e-9)
    np.testing.assert_allclose(rings.centre[inside, 2], rings.level[inside], atol=1e-9)


def test_two_lines_at_one_distance_count_together() -> None:
    V, F = two_components()
    near = F[(V[F][:, :, 0] < 5.0).all(axis=1)]
    one, both = girths(V, near, V[:, 2], 0.25), girths(V, F, V[:, 2], 0.25)
    np.testing.assert_allclose(both.girth, 2.0 * one.girth)
    np.testing.assert_allclose(both.centre[:, 0], one.centre[:, 0] + 5.0, atol=1e-9)


def test_a_moved_surface_has_the_same_girths_and_moved_middles() -> None:
    V, F = revolution([0.0, 2.0, 4.0, 6.0], [1.0, 2.0, 1.0, 1.5])
    plain, moved = girths(V, F, V[:, 2], 0.3), girths(V + [3.0, -1.0, 5.0], F, V[:, 2], 0.3)
    np.testing.assert_allclose(moved.girth, plain.girth)
    np.testing.assert_allclose(moved.centre, plain.centre + [3.0, -1.0, 5.0])


def test_a_ring_of_no_length_is_none() -> None:
    """At a tip the only line is a point, whose middle is nowhere."""
    V, F = revolution([0.0, 10.0], [0.1, 2.1])
    tip = len(V) - 2
    aside = V + [5.0, 5.0, 0.0]
    rings = girths(aside, F, np.linalg.norm(aside - aside[tip], axis=1), 0.5)
    assert rings.level.min() > 0.0
    np.testing.assert_allclose(rings.centre[:, :2], 5.0, atol=0.01)


def test_faces_of_which_no_distance_is_known_have_no_ring() -> None:
    V, F = revolution([0.0, 6.0], [1.0, 1.0])
    rings = girths(V, F, np.where(V[:, 2] > 3.0, np.inf, V[:, 2]), 0.5)
    assert rings.level.max() == pytest.approx(2.5)
