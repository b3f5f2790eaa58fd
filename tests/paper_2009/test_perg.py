"""Contract of perg: the ends of the body, nothing outside; a hand, however it is meshed and held."""

from functools import cache

import numpy as np
import pytest
from limbs import rotation
from skimage.measure import marching_cubes
from volumetric import volumetric

from kinetree.schemas.input.mesh import Cleaning, Mesh
from kinetree.schemas.paper_2009.perg import Perg, PergParams
from kinetree.schemas.paper_2009.reeb_graph import ReebGraphParams
from kinetree.schemas.topology.extrema import ExtremaParams
from kinetree.schemas.topology.geodesics import GeodesicsParams
from kinetree.tasks.paper_2009.perg import perg
from kinetree.tasks.paper_2009.reeb_graph import reeb_graph
from kinetree.tasks.topology.extrema import extrema
from kinetree.tasks.topology.geodesics import geodesics

FINGERTIPS = np.array([[-0.94, 0.0, 2.17], [-0.31, 0.0, 2.67], [0.31, 0.0, 2.87], [0.94, 0.0, 2.47], [1.4, 0.0, 0.82]])
"""Fingers and thumb of `hand`."""
TURN, SHIFT = rotation((1.0, 2.0, -1.0), 2.2), np.array([30.0, -5.0, 11.0])


@cache
def hand(spacing: float) -> tuple[np.ndarray, np.ndarray]:
    """A palm with four fingers and a thumb by marching cubes: V (vertex, xyz) and F (face, corner)."""
    axes = [np.arange(a, b, spacing) for a, b in ((-1.6, 1.8), (-0.6, 0.6), (-1.7, 3.2))]
    P = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)

    def capsule(a: tuple[float, float], b: tuple[float, float], radius: float) -> np.ndarray:
        start, way = np.array([a[0], 0.0, a[1]]), np.array([b[0] - a[0], 0.0, b[1] - a[1]])
        t = np.clip((P - start) @ way / (way @ way), 0.0, 1.0)
        return np.linalg.norm(P - start - t[..., None] * way, axis=-1) - radius

    parts = [capsule((x, -0.9), (x, 0.4), 0.3) for x in (-0.6, -0.2, 0.2, 0.6)]
    parts += [capsule((0.9 * x, 0.4), (1.3 * x, z), 0.17) for x, z in ((-0.72, 2.0), (-0.24, 2.5), (0.24, 2.7), (0.72, 2.3))]
    parts += [capsule((0.6, -0.5), (1.3, 0.7), 0.18)]
    V, F, _, _ = marching_cubes(np.min(parts, axis=0), 0.0, spacing=(spacing,) * 3)
    return V + [x[0] for x in axes], F.astype(np.int64)


def graph_of(V: np.ndarray, F: np.ndarray) -> tuple[Perg, np.ndarray]:
    """The graph of a mesh · (end, xyz) the tips that its ends hold."""
    mesh = Mesh(vertices=V, faces=F, vertex_of_input=np.arange(len(V)), cleaning=Cleaning(area=1.0))
    mu = geodesics(mesh, GeodesicsParams(bases=80))
    ends = extrema(mesh, mu, ExtremaParams())
    return perg(mesh, reeb_graph(mesh, mu, ReebGraphParams()), ends, PergParams()), V[ends.vertices]


@pytest.mark.parametrize("spacing", [0.09, 0.07])
def test_hand_has_an_end_in_every_finger_and_one_at_the_wrist(spacing: float) -> None:
    graph, tips = graph_of(*hand(spacing))
    near = np.linalg.norm(FINGERTIPS[:, None] - tips[None], axis=2)
    assert sorted(near.argmin(axis=1)) == sorted(np.argsort(tips[:, 2])[1:])  # all but the wrist's, which is lowest
    assert near.min(axis=1).max() < 0.2
    assert len(graph.end) == 6 == 2 + sum(degree - 2 for degree in graph.degrees)
    assert not len(graph.reach)
    assert not graph.outside.any()


def test_graph_of_a_hand_moves_with_it() -> None:
    V, F = hand(0.09)
    graph, _ = graph_of(V, F)
    moved, _ = graph_of(V @ TURN.T + SHIFT, F)
    assert np.array_equal(moved.edge, graph.edge)
    assert np.allclose(moved.node, graph.node @ TURN.T + SHIFT, atol=2e-3)


def test_graph_of_a_hand_is_the_same_on_another_mesh() -> None:
    one, other = (graph_of(*hand(spacing))[0] for spacing in (0.09, 0.07))
    far = np.linalg.norm(one.node[:, None] - other.node[None], axis=2)
    assert max(far.min(axis=0).max(), far.min(axis=1).max()) < 0.35
    assert one.degrees == other.degrees


def test_graph_of_three_arms_has_three_ends_one_branch_point_and_no_loop() -> None:
    for graph in volumetric().perg.values():
        assert len(graph.end) == 3
        assert graph.degrees == (3,)
        assert len(graph.reach) == 0


def test_nodes_and_edges_of_every_frame_are_inside() -> None:
    assert not any(graph.outside.any() for graph in volumetric().perg.values())


def test_every_vertex_has_a_node_and_every_branch_its_leaf() -> None:
    for graph in volumetric().perg.values():
        assert (graph.of_vertex >= 0).all()
        assert set(graph.branch.tolist()) == {-1, 0, 1, 2}
