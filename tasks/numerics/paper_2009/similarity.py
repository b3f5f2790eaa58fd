"""Similarity of two multiresolution Reeb graphs (2009, Sec. 2.3; Hilaga 2001, Sec. 5; Tung and Schmitt 2005).

From the coarsest level to the finest, nodes of equal bands are paired whose parents are paired, the most similar first. Pairs
add what their nodes have in common of each attribute, so that a graph has 1 in common with itself.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.paper_2009.reeb_graph import ReebGraph


class Attributes(NamedTuple):
    """What of a frame's graph is compared; nodes in the order of `ReebGraph`.

    band       : (node,) number of its band
    first, child : (node + 1,) · (entry,) children of each node
    share      : (node, attribute) of the whole; the nodes of one level sum to 1
    """

    band: Ints
    first: Ints
    child: Ints
    share: Floats


def attributes(graph: ReebGraph) -> Attributes:
    """Area of every node, and the breadth of its piece: the root of its area by the height of its band."""
    count = len(graph.level)
    has = np.flatnonzero(graph.parent >= 0)
    order = has[np.argsort(graph.parent[has], kind="stable")]
    first = np.searchsorted(graph.parent[order], np.arange(count + 1))
    share = np.stack([graph.area, np.sqrt(graph.area)], axis=1)
    levels = np.stack([np.bincount(graph.level, share[:, a]) for a in range(2)], axis=1)
    return Attributes(graph.band, first.astype(np.int64), order, share / np.maximum(levels[graph.level], 1e-300))


def similarities(frames: Sequence[Attributes], weight: float = 0.5) -> Floats:
    """(frame, frame) similarity of every pair, 1 on the diagonal.

    weight : of the area against the breadth
    """
    S = np.eye(len(frames))
    w = np.array([weight, 1.0 - weight])
    for i, one in enumerate(frames):
        for j, other in enumerate(frames[:i]):
            S[i, j] = S[j, i] = _similarity(*one, *other, w)
    return S


@compiled
def _similarity(
    band: Ints, first: Ints, child: Ints, share: Floats, band2: Ints, first2: Ints, child2: Ints, share2: Floats, w: Floats
) -> float:
    """Both graphs have one node on their coarsest level, which is the last."""
    waiting = [(len(band) - 1, len(band2) - 1)]
    used, used2 = np.zeros(len(band), np.bool_), np.zeros(len(band2), np.bool_)
    total, done = 0.0, 0
    while done < len(waiting):
        m, n = waiting[done]
        done += 1
        total += _common(share[m], share2[n], w)
        while True:
            best, a, b = -1.0, -1, -1
            for p in child[first[m] : first[m + 1]]:
                for q in child2[first2[n] : first2[n + 1]]:
                    if not used[p] and not used2[q] and band[p] == band2[q]:
                        s = _common(share[p], share2[q], w)
                        if s > best:
                            best, a, b = s, p, q
            if a < 0:
                break
            used[a], used2[b] = True, True
            waiting.append((a, b))
    whole = 0.0
    for n in range(len(band)):
        whole += _common(share[n], share[n], w)
    return total / whole


@compiled
def _common(one: Floats, other: Floats, w: Floats) -> float:
    return w[0] * min(one[0], other[0]) + w[1] * min(one[1], other[1])
