"""Laws of what a vertex sees, on shapes where straight lines are known."""

import numpy as np
import numpy.typing as npt
import pytest
import shapes

from kinetree.tasks.numerics.geometry import visibility
from kinetree.tasks.numerics.geometry.geodesic_graph import NARROWEST_WINDOW
from kinetree.tasks.numerics.geometry.surface import Surface

Floats = npt.NDArray[np.float64]


def seen_from(V: Floats, F: npt.NDArray[np.int64], vertex: int, limit: float) -> tuple[npt.NDArray[np.int64], Floats, Floats]:
    """Input vertices that one sees, edges first, how far and in which direction."""
    s = Surface.of(V, F)
    rings = s.ring_start, s.ring, s.ring_edge, s.apex, s.twin, s.length, s.ring_length
    tail = s.apex[[int(visibility.after(np.uint64(h))) for h in range(len(s.apex))]]
    head = s.apex[[int(visibility.before(np.uint64(h))) for h in range(len(s.apex))]]
    P = V[s.order]
    a, b = P[head] - P[tail], P[s.apex] - P[tail]
    angle = np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), (a * b).sum(axis=1))
    shape, _ = visibility.face_shapes(rings[0], rings[1], rings[2], angle, rings[5])
    links = np.empty(1000, np.uint32), *(np.empty(1000, np.float32) for _ in range(3))
    marks, v, none = np.zeros(len(V), np.uint32), np.uint64(np.flatnonzero(s.order == vertex)[0]), np.uint64(0)
    k = np.uint64(visibility.append_edges(v, rings, shape, marks, none, links))
    room = np.empty((visibility.MAX_WINDOWS, 8)), np.empty(visibility.MAX_WINDOWS, np.uint32)
    k = int(visibility.append_visible(v, limit**2, np.sin(NARROWEST_WINDOW), rings, shape, marks, none, k, links, *room))
    return s.order[links[0][:k]], links[1][:k].astype(float), links[2][:k].astype(float)


def test_the_three_half_edges_of_a_face_follow_each_other() -> None:
    for h in map(np.uint64, range(12)):
        assert visibility.after(h) // 3 == h // 3 == visibility.before(h) // 3
        assert visibility.before(visibility.after(h)) == h
        assert visibility.after(visibility.after(h)) == visibility.before(h) != h


@pytest.mark.parametrize("shear", [0.0, 1.5])
def test_in_the_plane_every_vertex_is_seen_where_it_is(shear: float) -> None:
    V, F = shapes.flat_grid(21, 21, shear)
    middle = 220
    target, far, direction = seen_from(V, F, middle, 9.0)
    away = V[target] - V[middle]
    assert np.allclose(far, np.linalg.norm(away, axis=1), rtol=1e-5)
    turned = direction - np.arctan2(away[:, 1], away[:, 0])
    assert np.abs((turned - turned[0] + np.pi) % (2 * np.pi) - np.pi).max() < 2e-3


def test_lines_leave_in_all_directions_and_no_gap_is_twice_as_wide_as_the_narrowest_window() -> None:
    V, F = shapes.flat_grid(31, 31)
    _, _, direction = seen_from(V, F, 480, 9.0)
    around = np.sort(direction)
    assert np.diff(np.append(around, around[0] + 2 * np.pi)).max() < 2 * NARROWEST_WINDOW


def test_nothing_is_seen_beyond_the_limit_but_the_ends_of_edges() -> None:
    V, F = shapes.flat_grid(31, 31)
    _, far, _ = seen_from(V, F, 480, 2.5)
    assert 2.0 < far.max() <= 2.5
    assert len(seen_from(V, F, 480, 0.5)[0]) == 6


def test_directions_are_those_of_the_arctangent() -> None:
    theta = np.linspace(0, np.pi, 1001)
    angles = [visibility.direction(3 * np.cos(t), 3 * np.sin(t)) for t in theta]
    assert np.abs(angles - theta).max() < 1e-3
