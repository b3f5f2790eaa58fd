"""Neighbours of vertices over the edges of a mesh."""

import numpy as np

from kinetree.tasks.numerics.arrays import Ints


def rings(F: Ints, vertices: int) -> tuple[Ints, Ints]:
    """Neighbours over edges, each once, whatever the number of faces at the edge.

    F        : (face, corner)
    vertices : how many there are
    returns  : (vertex + 1,) where each vertex's begin · (entry,) the neighbours, ascending
    """
    tail, head = F.ravel(), F[:, [1, 2, 0]].ravel()
    code = distinct(np.concatenate([tail * vertices + head, head * vertices + tail]))
    return np.searchsorted(code, np.arange(vertices + 1) * vertices), code % vertices


def distinct(code: Ints) -> Ints:
    """Ascending, each once: numpy's own `unique` goes through a hash table, which takes three times as long here."""
    code = np.sort(code)
    return code[np.append(True, code[1:] != code[:-1])] if len(code) else code
