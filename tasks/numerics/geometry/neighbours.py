"""Neighbours of vertices over the edges of a mesh."""

import numpy as np
from scipy.sparse import coo_array, csr_array

from kinetree.tasks.numerics.arrays import Floats, Ints

_SHORTEST = 1e-300
"""Length of an edge without any, mesh unit: an entry of 0 would be no edge. It adds nothing to any other length."""


def rings(F: Ints, vertices: int) -> tuple[Ints, Ints]:
    """Neighbours over edges, each once, whatever the number of faces at the edge.

    F        : (face, corner)
    vertices : how many there are
    returns  : (vertex + 1,) where each vertex's begin · (entry,) the neighbours, ascending
    """
    tail, head = F.ravel(), F[:, [1, 2, 0]].ravel()
    code = distinct(np.concatenate([tail * vertices + head, head * vertices + tail]))
    return np.searchsorted(code, np.arange(vertices + 1) * vertices), code % vertices


def ring_edges(start: Ints, ring: Ints) -> Ints:
    """(entry, 2) every vertex with each of its neighbours, an edge both ways; start, ring as `rings` gives them."""
    return np.stack([np.repeat(np.arange(len(start) - 1), np.diff(start)), ring], axis=1)


def edge_lengths(V: Floats, edge: Ints) -> csr_array:
    """The graph of the edges by their lengths, as shortest paths take it.

    V       : (vertex, xyz) mesh unit
    edge    : (entry, 2) from which vertex to which, each once; both ways, unless paths may go against them
    returns : (vertex, vertex) mesh unit, above 0 for every edge
    """
    length = np.maximum(np.linalg.norm(V[edge[:, 0]] - V[edge[:, 1]], axis=1), _SHORTEST)
    tail, head = edge.astype(np.int32).T  # older versions of scipy find paths over no others
    return coo_array((length, (tail, head)), shape=(len(V), len(V))).tocsr()


def distinct(code: Ints) -> Ints:
    """Ascending, each once: numpy's own `unique` goes through a hash table, which takes three times as long here."""
    code = np.sort(code)
    return code[np.append(True, code[1:] != code[:-1])] if len(code) else code
