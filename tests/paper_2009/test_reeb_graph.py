"""Contract of reeb_graph: a partition of the surface on every resolution."""

import numpy as np
from volumetric import volumetric


def test_pieces_of_every_resolution_have_the_whole_area() -> None:
    here = volumetric()
    for graph in here.reeb_graph.values():
        areas = np.bincount(graph.level, graph.area)
        assert np.allclose(areas, areas[-1])


def test_three_arms_are_a_tree_with_three_ends_more_than_its_bands_are_cut() -> None:
    graph = volumetric().reeb_graph[0]
    finest = int((graph.level == 0).sum())
    assert len(graph.edge) == finest - 1
