"""Laws of one front running over a surface."""

import numpy as np
import shapes

from kinetree.tasks.numerics.geometry.bucketed_dijkstra import propagate, workspace
from kinetree.tasks.numerics.geometry.surface import Surface


def test_what_the_workspace_held_before_leaves_no_trace() -> None:
    surface = Surface.of(*shapes.sphere(3))
    mesh = surface.links
    fresh, used = (workspace(len(surface.order), len(surface.links.link)) for _ in range(2))
    propagate(mesh, np.uint64(5), surface.edge, np.inf, fresh)
    propagate(mesh, np.uint64(400), surface.edge, 0.7, used)
    propagate(mesh, np.uint64(5), surface.edge, np.inf, used)
    assert np.array_equal(fresh[0], used[0])


def test_one_long_edge_among_short_ones_is_waited_for() -> None:
    # far beyond the bands that the queue holds at once
    V, F = shapes.flat_grid(30, 30)
    tip = len(V)
    surface = Surface.of(np.concatenate([V, [[29.0, 400.0, 0.0]]]), np.concatenate([F, [[898, 899, tip]]]))
    work = workspace(len(surface.order), len(surface.links.link))
    inside = np.flatnonzero(surface.order == 0)[0]
    propagate(surface.links, np.uint64(inside), surface.edge, np.inf, work)
    assert np.isclose(work[0][np.flatnonzero(surface.order == tip)[0]], np.hypot(29, 29) + 371.0, rtol=0.01)
