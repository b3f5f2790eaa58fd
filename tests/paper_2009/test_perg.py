"""Contract of perg: ends and branches of the body, everything inside."""

from volumetric import volumetric


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
