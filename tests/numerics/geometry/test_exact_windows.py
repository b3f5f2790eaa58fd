"""Laws of windows in the plane, where light goes straight."""

import numpy as np
import shapes

from kinetree.tasks.numerics.geometry import exact_windows as windows
from kinetree.tasks.numerics.geometry.surface import Surface
from kinetree.tasks.numerics.geometry.visibility import before


def test_the_third_vertex_is_where_the_sides_put_it() -> None:
    length = np.array([4.0, 3.0, 5.0], np.float32)  # 0 to 1, 1 to 2, 2 to 0
    assert np.allclose(windows.third(np.uint64(0), length), [4.0, 3.0])
    assert np.allclose(windows.third(np.uint64(1), length), [0.0, 4.0])


def test_light_between_two_rays_meets_what_lies_between_them_and_nothing_else() -> None:
    V, F = shapes.flat_grid(21, 21)
    surface = Surface.of(V, F)
    P = V[surface.order]
    source = np.uint64(np.flatnonzero(surface.order == 0)[0])
    h = next(e for e in surface.ring_edge[surface.ring_start[source] :] if np.hypot(*(P[head(surface, e)])[:2]) == 1.0)
    room = windows.plane(len(P))
    room[0][:] = np.inf
    along = P[head(surface, h)][:2]
    across = np.array([-along[1], along[0]])
    slopes = 0.1, 0.4
    right, left = ((1.0, slope) for slope in slopes)
    windows.shine(np.uint64(h), *left, *right, 0.0, 15.0, (surface.apex, surface.twin, surface.length), room)
    slope = (P[:, :2] @ across) / np.maximum(P[:, :2] @ along, 1e-9)
    far = np.linalg.norm(P, axis=1)
    inside = (slope > slopes[0] + 1e-3) & (slope < slopes[1] - 1e-3) & (far < 15)
    outside = (slope < slopes[0] - 1e-3) | (slope > slopes[1] + 1e-3)
    assert inside.sum() > 20
    assert np.allclose(room[0][inside], far[inside], rtol=1e-6)
    assert np.isinf(room[0][outside]).all()


def head(surface: Surface, h: int) -> int:
    """The vertex at which a half-edge ends: the apex of the one before it."""
    return int(surface.apex[int(before(np.uint64(h)))])
