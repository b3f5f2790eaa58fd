"""Laws of the deformation graph, on tubes and spheres."""

import numpy as np
import pytest
from limbs import RADIUS, tube
from shapes import sphere, two_components
from shipped import GRAPH

from kinetree.tasks.numerics.geometry.normals import smoothed_normals
from kinetree.tasks.numerics.geometry.thickness import thickness
from kinetree.tasks.numerics.registration.deformation_graph import BOUND, deformation_graph

FEW = GRAPH._replace(nodes=60)


@pytest.fixture(scope="module")
def body():
    return deformation_graph(*tube(), FEW)


def test_weights_are_a_partition_of_unity(body):
    assert body.weight.min() >= 0
    np.testing.assert_allclose(body.weight.sum(axis=1), 1.0, atol=1e-12)


def test_a_vertex_follows_four_different_nodes_in_ascending_order(body):
    assert body.bound.shape == (len(body.V), BOUND)
    assert (np.diff(body.bound, axis=1) > 0).all()


def test_the_vertex_of_a_node_follows_that_node_most(body):
    most = np.take_along_axis(body.bound, body.weight.argmax(axis=1)[:, None], axis=1)[:, 0]
    np.testing.assert_array_equal(most[body.node], np.arange(len(body.node)))


def test_all_nodes_are_tied_together_and_none_to_itself(body):
    assert (body.edge[:, 0] < body.edge[:, 1]).all()
    assert len(np.unique(body.edge, axis=0)) == len(body.edge)
    reached = {0}
    for _ in range(len(body.node)):
        reached |= {int(b) for a, b in body.edge if a in reached} | {int(a) for a, b in body.edge if b in reached}
    assert len(reached) == len(body.node)


def test_struts_go_through_the_body_and_no_struts_leave_only_ties_over_the_surface():
    V, F = tube()
    without, through = (deformation_graph(V, F, GRAPH._replace(nodes=60, strut=strut)) for strut in (0.0, 0.4))
    pairs = {tuple(e) for e in through.edge} - {tuple(e) for e in without.edge}
    assert {tuple(e) for e in without.edge} <= {tuple(e) for e in through.edge}
    a, b = np.array(sorted(pairs)).T
    facing = np.einsum("ex,ex->e", through.N[through.node[a]], through.N[through.node[b]])
    assert (facing < 0).mean() > 0.9


def test_the_thickness_of_a_tube_is_its_width_whatever_else_the_body_has():
    V, F = tube(around=48, along=96, flat=1.0)
    middle = np.abs(V[:, 2]) < 3
    np.testing.assert_allclose(thickness(V, smoothed_normals(V, F), 40.0)[middle], 2 * RADIUS, rtol=0.02)


def test_a_ball_is_nowhere_thin():
    V, F = sphere(3)
    assert np.isinf(thickness(V, smoothed_normals(V, F), np.sqrt(4 * np.pi))).all()


def test_nodes_lie_closer_where_the_body_is_thin():
    V, F = tube(around=32, along=120)
    V = V * np.where(V[:, 2:] > 0, [[0.3, 0.3, 1.0]], [[1.0, 1.0, 1.0]])
    body = deformation_graph(V, F, GRAPH._replace(nodes=200, thick=0.4))
    thin, thick = ((V[body.node, 2] * side > 1).sum() / _area(V, F, side) for side in (1, -1))
    assert thin > 2 * thick


def _area(V, F, side):
    inside = (V[F, 2].mean(axis=1)) * side > 1
    corner = V[F[inside]]
    return np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1).sum() / 2


def test_every_node_has_samples_of_its_own(body):
    nearest = np.take_along_axis(body.bound, body.weight.argmax(axis=1)[:, None], axis=1)[:, 0]
    assert set(nearest[body.sample]) == set(range(len(body.node)))


def test_every_component_gets_nodes_and_follows_only_its_own():
    V, F = two_components(3)
    body = deformation_graph(V, F, GRAPH._replace(nodes=40))
    first = body.node < len(V) // 2
    assert first.any()
    assert not first.all()
    followed = first[body.bound] == (np.arange(len(V)) < len(V) // 2)[:, None]
    assert (body.weight[~followed] == 0).all()


def test_a_component_with_a_single_node_moves_with_it():
    V, F = two_components(3)
    body = deformation_graph(V, F, GRAPH._replace(nodes=2))
    np.testing.assert_allclose(body.weight.sum(axis=1), 1.0)
    np.testing.assert_array_equal(body.bound.max(axis=1), np.arange(len(V)) >= len(V) // 2)


def test_more_nodes_than_vertices_are_one_a_vertex():
    V, F = sphere(1)
    np.testing.assert_array_equal(deformation_graph(V, F, GRAPH._replace(nodes=1000)).node, np.arange(len(V)))


def test_scale_and_place_change_no_choice():
    V, F = tube()
    V = V * (1 + 0.02 * np.random.default_rng(0).normal(size=(len(V), 1)))  # a symmetric shape has ties
    body, moved = deformation_graph(V, F, FEW), deformation_graph(1000 * V + [4.0, 5.0, 6.0], F, FEW)
    np.testing.assert_array_equal(moved.node, body.node)
    np.testing.assert_array_equal(moved.edge, body.edge)
    np.testing.assert_allclose(moved.weight, body.weight, atol=1e-5)
    assert moved.size == pytest.approx(1000 * body.size)
