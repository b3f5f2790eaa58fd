"""Tree edit distance: how many joints must be inserted or deleted to make two trees equal, whatever their positions.

Joints have neither labels nor an order, and the choice of the root is a convention. So the trees are compared as unordered,
unlabelled trees without a root. The distance of rigging papers (Zhang, Shasha 1989) depends on the order in which children are
listed. The general unordered distance is NP-hard; this one is the constrained distance (Zhang 1996), in which separate branches
stay separate, minimised over the roots of both trees. It is 0 if and only if the trees are equal.
"""

from collections.abc import Sequence
from functools import cache

import networkx as nx
import numpy as np
from scipy.optimize import linear_sum_assignment


def contracted_tree(parents: Sequence[int], remains: Sequence[bool]) -> list[int]:
    """The tree without some joints: the parent of each remaining joint is its nearest remaining ancestor.

    parents : (joint,) parent of every joint, −1 for a root; in any order
    remains : (joint,) which joints remain; one of them must be above all others
    returns : (remaining joint,) parent as a number among the remaining joints, −1 for the root
    """
    place = {j: k for k, j in enumerate(j for j, remaining in enumerate(remains) if remaining)}
    ancestors = remaining_ancestors(parents, remains)
    return [place[ancestors[parents[j]]] if parents[j] >= 0 and ancestors[parents[j]] >= 0 else -1 for j in place]


def remaining_ancestors(parents: Sequence[int], remains: Sequence[bool]) -> list[int]:
    """The nearest remaining joint at or above each joint.

    parents : (joint,) parent of every joint, −1 for a root
    remains : (joint,) which joints remain
    returns : (joint,) a remaining joint, −1 where there is none
    """
    ancestors = []
    for j in range(len(parents)):
        while j >= 0 and not remains[j]:
            j = parents[j]
        ancestors.append(j)
    return ancestors


def tree_edit_distance(parents: Sequence[int], others: Sequence[int]) -> int:
    """Least number of insertions and deletions of joints that make two unordered trees without root equal (Zhang 1996).

    parents : (joint,) parent of every joint of the first tree, −1 for its only root
    others  : (joint,) the same of the second tree
    """
    one, two = _neighbours(parents), _neighbours(others)
    if not one or not two:
        return max(len(one), len(two))

    @cache
    def size(tree: int, v: int, above: int) -> int:
        return 1 + sum(size(tree, c, v) for c in (one, two)[tree][v] if c != above)

    @cache
    def trees(v: int, v_above: int, w: int, w_above: int) -> int:
        """Distance of the branch at v, seen from its neighbour above, from the branch at w."""
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
        """Distance of the branches below v from the branches below w."""
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
    """Least cost to pair branches of both trees, to delete the others of the first and to insert those of the second."""
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
    """The neighbours of every joint in the tree without root, ascending."""
    graph: nx.Graph[int] = nx.Graph()
    graph.add_nodes_from(range(len(parents)))
    graph.add_edges_from((p, j) for j, p in enumerate(parents) if p >= 0)
    return {v: sorted(graph.neighbors(v)) for v in graph}
