"""Laws of the tree of nodes and its surface."""

import numpy as np
from limbs import tube

from kinetree.tasks.numerics.paper_2009.graph_body import GraphBody, graph_body
from kinetree.tasks.numerics.paper_2009.perg import perg
from kinetree.tasks.numerics.paper_2009.reeb_graph import reeb_graph


def straight(spacing: float = 0.0) -> tuple[np.ndarray, np.ndarray, GraphBody]:
    V, F = tube(16, 60, flat=1.0)
    f = V[:, 2].copy()
    ends = np.array([int(f.argmin()), int(f.argmax())])
    g = perg(V, F, reeb_graph(V, F, f, 4), ends, start=0)
    return V, F, graph_body(V, F, g.node, g.edge, g.loop, g.area, g.end, g.of_vertex, spacing=spacing)


def test_joints_are_amid_the_edges() -> None:
    _, _, body = straight()
    child = np.arange(1, len(body.node))
    assert np.allclose(body.joint[1:], (body.node[child] + body.node[body.parents[child]]) / 2)


def test_surface_follows_the_node_of_its_band() -> None:
    V, _, body = straight()
    away = np.abs(V[:, 2] - body.node[body.label, 2])
    assert away.max() < 1.0
    assert np.allclose(body.weight.sum(axis=1), 1.0)


def test_tube_is_two_branches_up_to_their_meeting() -> None:
    _, _, body = straight()
    assert len(body.end) == 2
    assert (body.branch >= 0).all()


def test_nodes_of_a_chain_are_as_far_apart_as_asked_and_ends_stay() -> None:
    _, _, wide = straight(1.5)
    _, _, narrow = straight()
    length = np.linalg.norm(wide.node[1:] - wide.node[wide.parents[1:]], axis=1)
    assert len(wide.node) < len(narrow.node)
    assert length.min() >= 1.5
    assert np.ptp(wide.node[:, 2]) == np.ptp(narrow.node[:, 2])
