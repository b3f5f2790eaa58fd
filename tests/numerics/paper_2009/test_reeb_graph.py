"""Laws of the Reeb graph: loops of handles, exact areas, the same for every tessellation and position."""

import numpy as np
import pytest
import trimesh
from limbs import rotation
from shapes import y_pipe

from kinetree.tasks.numerics.paper_2009.reeb_graph import ReebGraph, active_nodes, reeb_graph


def independent_loops(graph: ReebGraph) -> int:
    """Edges beyond those of a tree, for a connected graph."""
    return len(graph.edge) - int((graph.level == 0).sum()) + 1


def height_graph(mesh: trimesh.Trimesh, levels: int = 5) -> ReebGraph:
    """Of the height x, which has a saddle on either side of a torus' hole."""
    V = np.array(mesh.vertices, np.float64)
    return reeb_graph(V, np.array(mesh.faces, np.int64), V[:, 0].copy(), levels)


def test_torus_has_one_loop_and_sphere_none() -> None:
    assert independent_loops(height_graph(trimesh.creation.torus(3.0, 1.0))) == 1
    assert independent_loops(height_graph(trimesh.creation.icosphere(3))) == 0


def test_areas_are_those_of_zones_of_the_sphere() -> None:
    ball = trimesh.creation.icosphere(5)
    graph = height_graph(ball, 3)
    assert np.allclose(graph.area[graph.level == 0], ball.area / 8, rtol=0.01)  # Archimedes


def test_subdividing_faces_changes_no_node() -> None:
    mesh = trimesh.creation.torus(3.0, 1.0, major_sections=24, minor_sections=12)
    one, other = height_graph(mesh), height_graph(mesh.subdivide())
    assert np.array_equal(np.sort(one.band), np.sort(other.band))
    assert np.allclose(np.sort(one.area), np.sort(other.area))
    assert len(one.edge) == len(other.edge)


def test_nodes_turn_with_the_body() -> None:
    V, F, _ = y_pipe()
    f = np.linalg.norm(V, axis=1)
    R = rotation((1.0, 2.0, 3.0), 1.1)
    one, other = reeb_graph(V, F, f, 4), reeb_graph(V @ R.T + 5.0, F, f, 4)
    assert np.allclose(one.centre @ R.T + 5.0, other.centre)
    assert np.array_equal(one.edge, other.edge)


@pytest.mark.parametrize("level", range(6))
def test_every_level_is_made_of_the_one_below(level: int) -> None:
    graph = height_graph(trimesh.creation.torus(3.0, 1.0))
    own, finest = active_nodes(graph, level), graph.level == 0
    area = np.bincount(own, graph.area[finest], len(graph.level))
    assert np.allclose(area[graph.level == level], graph.area[graph.level == level])


def test_vertices_are_in_the_band_of_their_height() -> None:
    ball = trimesh.creation.icosphere(3)
    graph = height_graph(ball, 3)
    x = np.array(ball.vertices)[:, 0]
    band = np.clip(((x - x.min()) / np.ptp(x) * 8).astype(int), 0, 7)
    assert np.array_equal(graph.band[graph.of_vertex], band)
