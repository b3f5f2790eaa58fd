"""Laws of the graph inside the body: everything inside, loops that handles make, leaves kept."""

import numpy as np
import pytest
import trimesh
from limbs import bent, tube

from kinetree.tasks.numerics.geometry.inside import inside
from kinetree.tasks.numerics.paper_2009.perg import leaving, moved_inside, perg
from kinetree.tasks.numerics.paper_2009.reeb_graph import reeb_graph


def hooked() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A tube bent by 100°: the centre of its coarse pieces is outside. V, F and the height along the tube."""
    V, F = tube(16, 60, flat=1.0)
    return bent(V, 1.75), F, V[:, 2].copy()


def test_nodes_outside_are_replaced_until_all_is_inside() -> None:
    V, F, f = hooked()
    graph = reeb_graph(V, F, f, 5)
    ends = np.array([int(f.argmin()), int(f.argmax())])
    coarse = perg(V, F, graph, ends, start=5, moved_inside=False)
    assert coarse.replaced > 0
    whole = perg(V, F, graph, ends, start=5)
    assert not whole.outside.any()
    assert inside(whole.node, V, F).all()


def test_torus_keeps_its_loop_and_a_short_one_is_opened() -> None:
    ring = trimesh.creation.torus(3.0, 1.0)
    V, F = np.array(ring.vertices), np.array(ring.faces)
    graph = reeb_graph(V, F, V[:, 0].copy(), 5)
    none = np.zeros(0, np.int64)
    assert len(perg(V, F, graph, none, start=0).reach) == 1
    assert len(perg(V, F, graph, none, start=0, least_loop=0.95).reach) == 0


def test_sphere_without_leaves_is_one_node() -> None:
    ball = trimesh.creation.icosphere(3)
    V, F = np.array(ball.vertices), np.array(ball.faces)
    alone = perg(V, F, reeb_graph(V, F, V[:, 0].copy(), 4), np.zeros(0, np.int64))
    assert (len(alone.node), len(alone.edge)) == (1, 0)


def test_edge_through_the_surface_leaves_the_body() -> None:
    V, F, f = hooked()
    tips = np.array([V[f < f.min() + 0.5].mean(axis=0), V[f > f.max() - 0.5].mean(axis=0)])
    assert leaving(V, F, tips, np.array([[0, 1]]))[0]


@pytest.mark.parametrize("seed", range(3))
def test_points_outside_are_moved_inside(seed: int) -> None:
    ball = trimesh.creation.icosphere(3)
    P = np.random.default_rng(seed).normal(size=(20, 3)) * 2
    assert inside(moved_inside(P, np.array(ball.vertices), np.array(ball.faces)), np.array(ball.vertices), ball.faces).all()
