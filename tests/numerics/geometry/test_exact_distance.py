"""Laws of the exact distances around a source, on shapes whose distances are known and against another program's."""

import numpy as np
import numpy.typing as npt
import pytest
import shapes

from kinetree.tasks.numerics.geometry.exact_distance import light
from kinetree.tasks.numerics.geometry.exact_windows import Plane, plane
from kinetree.tasks.numerics.geometry.surface import Surface

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


def lit(surface: Surface, source: int, limit: float) -> tuple[Floats, Plane]:
    """Distances around one input vertex, in the input's numbering, and the room they were found in."""
    room = plane(len(surface.order))
    room[0][:] = np.inf
    inside = np.uint64(np.flatnonzero(surface.order == source)[0])
    s = surface
    links = (s.apex, s.twin, s.length)
    light(inside, limit, 0.25 * s.edge, s.ring_start, s.ring, s.ring_edge, s.bends, links, room)
    found = np.empty(len(s.order))
    found[s.order] = room[0]
    return found, room


def assert_exact(V: Floats, F: Ints, source: int, exact: Floats, edges: float = 8.0) -> None:
    surface = Surface.of(V, F)
    limit = edges * surface.edge
    found, _ = lit(surface, source, limit)
    near = exact <= limit
    assert near.sum() > 50
    assert np.allclose(found[near], exact[near], rtol=1e-5)
    assert np.all(found >= exact * (1 - 1e-5))


def test_around_a_source_in_the_plane_distance_is_the_straight_line() -> None:
    for shear in (0.0, 3.0):
        V, F = shapes.flat_grid(40, 40, shear)
        for source in (0, 820, 1599):
            assert_exact(V, F, source, np.linalg.norm(V - V[source], axis=1))


def test_around_a_source_on_a_cylinder_with_open_ends_distance_is_the_straight_line_on_its_unrolled_sides() -> None:
    V, F = shapes.open_cylinder(12, 31)
    for source in (0, 15, 200):
        assert_exact(V, F, source, shapes.over_cylinder(V, source, 12))


def test_a_path_around_a_notch_bends_at_its_corner() -> None:
    V, F = shapes.flat_grid(41, 41)
    middle = V[F].mean(axis=1)
    F = F[~((middle[:, 0] > 20) & (middle[:, 1] < 20))]
    used = ~((V[:, 0] > 20) & (V[:, 1] < 20))
    source, corner = 20 * 41 - 41 * 3 + 12, np.array([20.0, 20.0, 0.0])
    s = V[source]
    direct = V - s
    # the corner hides what lies to the right of the ray from the source through it
    hidden = (corner - s)[0] * direct[:, 1] - (corner - s)[1] * direct[:, 0] < 0
    hidden &= V[:, 0] > 20
    around = np.linalg.norm(corner - s) + np.linalg.norm(V - corner, axis=1)
    exact = np.where(hidden, around, np.linalg.norm(direct, axis=1))
    exact[~used] = np.inf
    assert hidden[used].any()
    assert_exact(V, F, source, exact, edges=12.0)


def test_another_program_finds_the_same_around_a_source_on_a_rough_body_with_a_sharp_rim() -> None:
    peer = pytest.importorskip("pygeodesic.geodesic", reason="pygeodesic computes the exact distances")
    V, F, _ = shapes.y_pipe()
    for rough in (V, V + np.random.default_rng(3).normal(scale=0.08, size=V.shape)):
        solver = peer.PyGeodesicAlgorithmExact(rough, F.astype(np.int32))
        for source in (0, 333, 666):
            assert_exact(rough, F, source, solver.geodesicDistances(np.array([source]), None)[0])


def test_light_that_is_lost_at_an_edge_of_three_faces_is_owned_up_to() -> None:
    V, F, _ = shapes.three_pages(20, 30)
    surface = Surface.of(V, F)
    far, near = int(np.argmax(np.hypot(V[:, 0], V[:, 1]))), 15
    assert lit(surface, far, 5.0)[1][-1][-1] == 0
    assert lit(surface, near, 5.0)[1][-1][-1] == 1
