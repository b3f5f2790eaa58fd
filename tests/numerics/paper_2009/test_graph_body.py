"""Laws of the tree of nodes and its surface."""

import numpy as np
from limbs import tube

from kinetree.tasks.numerics.paper_2009.graph_body import GraphBody, graph_body
from kinetree.tasks.numerics.paper_2009.perg import perg
from kinetree.tasks.numerics.paper_2009.reeb_graph import reeb_graph


def straight() -> tuple[np.ndarray, np.ndarray, GraphBody]:
    V, F = tube(16, 60, flat=1.0)
    f = V[:, 2].copy()
    ends = np.array([int(f.argmin()), int(f.argmax())])
    g = perg(V, F, reeb_graph(V, F, f, 4), ends, start=0)
    return V, F, graph_body(V, F, g.node, g.edge, g.loop, g.area, g.end, g.of_vertex)


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
