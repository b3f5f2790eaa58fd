"""Laws of neighbours over edges, and of the edges' lengths."""

import numpy as np
import pytest
from scipy.sparse.csgraph import dijkstra
from shapes import y_pipe

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.neighbours import edge_lengths, ring_edges, rings

SQUARE = np.array([[0, 0, 0], [3, 0, 0], [3, 4, 0], [0, 4, 0]], float)
HALVES = np.array([[0, 1, 2], [0, 2, 3]])
"""Faces of the square, with its diagonal from 0 to 2."""


def graph(V: Floats, F: Ints) -> Floats:
    return np.asarray(edge_lengths(V, ring_edges(*rings(F, len(V)))).toarray())


def test_edges_of_a_vertex_lead_to_its_neighbours() -> None:
    edge = ring_edges(*rings(HALVES, 5))
    assert edge.tolist() == [[0, 1], [0, 2], [0, 3], [1, 0], [1, 2], [2, 0], [2, 1], [2, 3], [3, 0], [3, 2]]


def test_sides_of_a_square_and_its_diagonal_have_their_lengths() -> None:
    np.testing.assert_array_equal(graph(SQUARE, HALVES), [[0, 3, 5, 4], [3, 0, 4, 0], [5, 4, 0, 3], [4, 0, 3, 0]])


def test_an_edge_of_many_faces_is_as_long_as_one_of_one_face() -> None:
    fan = np.array([[0, 1, 2], [0, 1, 3], [1, 0, 3], [0, 1, 2]])
    assert graph(SQUARE, fan)[0, 1] == 3.0


def test_lengths_are_the_same_both_ways_to_the_last_bit() -> None:
    V, F, _ = y_pipe()
    L = graph(V, F)
    np.testing.assert_array_equal(L, L.T)


def test_an_entry_leads_one_way() -> None:
    L = edge_lengths(SQUARE, np.array([[0, 1], [1, 2]]))
    np.testing.assert_array_equal(dijkstra(L, indices=0), [0, 3, 7, np.inf])
    np.testing.assert_array_equal(dijkstra(L, indices=2), [np.inf, np.inf, 0, np.inf])


def test_an_edge_between_vertices_in_one_place_is_an_edge_and_lengthens_no_path() -> None:
    V = SQUARE.copy()
    V[1] = V[0]
    L = edge_lengths(V, ring_edges(*rings(HALVES, 4)))
    assert (L.data > 0).all()
    assert L[0, 1] > 0
    assert dijkstra(L, indices=1)[[2, 3]].tolist() == [5.0, 4.0]


@pytest.mark.parametrize("scale", [1e-6, 1e6])
def test_lengths_grow_with_the_mesh(scale: float) -> None:
    np.testing.assert_allclose(graph(scale * SQUARE, HALVES), scale * graph(SQUARE, HALVES), rtol=1e-15)
