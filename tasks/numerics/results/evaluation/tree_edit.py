"""Tree edit distance: how many joints must be inserted or deleted to make one tree the other.

Joints have no labels and no order, and which of them is the root is a convention; so the trees compared are unordered,
unlabelled and free, where the distance published by rigging papers (Zhang, Shasha 1989) follows the order in which children
happen to be listed. The general unordered distance is NP-hard; this is the constrained one (Zhang 1996), in which separate
branches stay separate, minimised over the roots of both trees. It is 0 exactly where the trees are the same.
"""

from collections.abc import Sequence
from functools import cache

import networkx as nx
import numpy as np
from scipy.optimize import linear_sum_assignment


def contracted(parents: Sequence[int], kept: Sequence[bool]) -> list[int]:
    """(kept joint,) parents among the kept joints: each hangs on its nearest kept ancestor.

    parents : (joint,) −1 for a root; parents come before children or after, as they like
    kept    : (joint,) which joints stay; one of them must be above all others
    """
    place = {j: k for k, j in enumerate(j for j, keep in enumerate(kept) if keep)}
    ancestors = kept_ancestors(parents, kept)
    return [place[ancestors[parents[j]]] if parents[j] >= 0 and ancestors[parents[j]] >= 0 else -1 for j in place]


def kept_ancestors(parents: Sequence[int], kept: Sequence[bool]) -> list[int]:
    """(joint,) the nearest kept joint at or above each; −1 where there is none."""
    out = []
    for j in range(len(parents)):
        while j >= 0 and not kept[j]:
            j = parents[j]
        out.append(j)
    return out


def tree_edit_distance(parents: Sequence[int], others: Sequence[int]) -> int:
    """Fewest insertions and deletions of joints that make two free unordered trees the same (after Zhang 1996).

    parents, others : (joint,) parent of every joint, −1 for the root; one root each
    """
    one, two = _neighbours(parents), _neighbours(others)
    if not one or not two:
        return max(len(one), len(two))

    @cache
    def size(tree: int, v: int, above: int) -> int:
        return 1 + sum(size(tree, c, v) for c in (one, two)[tree][v] if c != above)

    @cache
    def trees(v: int, v_above: int, w: int, w_above: int) -> int:
        """The branch at v, seen from above it, against the branch at w."""
        best = forests(v, v_above, w, w_above)
        here, there = size(0, v, v_above), size(1, w, w_above)
        for c in one[v]:
            if c != v_above:
                best = min(best, here - size(0, c, v) + trees(c, v, w, w_above))
        for d in two[w]:
            if d != w_above:
                best = min(best, there - size(1, d, w) + trees(v, v_above, d, w))
        return best

    @cache
    def forests(v: int, v_above: int, w: int, w_above: int) -> int:
        """What hangs on v against what hangs on w."""
        left = [c for c in one[v] if c != v_above]
        right = [d for d in two[w] if d != w_above]
        here, there = size(0, v, v_above) - 1, size(1, w, w_above) - 1
        best = _matched(
            [[trees(c, v, d, w) for d in right] for c in left], [size(0, c, v) for c in left], [size(1, d, w) for d in right]
        )
        for c in left:
            best = min(best, here - (size(0, c, v) - 1) + forests(c, v, w, w_above))
        for d in right:
            best = min(best, there - (size(1, d, w) - 1) + forests(v, v_above, d, w))
        return best

    return min(trees(v, -1, w, -1) for v in one for w in two)


def _matched(cost: list[list[int]], deleted: list[int], inserted: list[int]) -> int:
    """Cheapest way to pair branches, delete those of the one tree and insert those of the other."""
    n, m = len(deleted), len(inserted)
    if not n or not m:
        return sum(deleted) + sum(inserted)
    square = np.zeros((n + m, n + m))
    square[:n, :m] = cost
    square[:n, m:] = np.where(np.eye(n, dtype=bool), np.array(deleted)[:, None], 10**9)
    square[n:, :m] = np.where(np.eye(m, dtype=bool), np.array(inserted)[None], 10**9)
    rows, columns = linear_sum_assignment(square)
    return round(float(square[rows, columns].sum()))


def _neighbours(parents: Sequence[int]) -> dict[int, list[int]]:
    graph: nx.Graph[int] = nx.Graph()
    graph.add_nodes_from(range(len(parents)))
    graph.add_edges_from((p, j) for j, p in enumerate(parents) if p >= 0)
    return {v: sorted(graph.neighbors(v)) for v in graph}
