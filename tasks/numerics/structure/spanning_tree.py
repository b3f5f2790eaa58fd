"""One tree over all parts: the spanning tree of the borders that turn best about a point, and its root (2014, Sec. 6.3)."""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints


class RootedTree(NamedTuple):
    """Parts in an order in which parents come before children.

    order   : (part,) the part at each place of the order, the root's first
    parents : (part,) place of each one's parent, −1 for the root
    border  : (part,) the border between each and its parent, −1 for the root
    """

    order: Ints
    parents: Ints
    border: Ints


def spanning(pair: Ints, cost: Floats, parts: int) -> Ints:
    """The borders of a minimum spanning tree; of equally good ones the earlier (Kruskal 1956; 2014, Sec. 6.3).

    pair    : (border, 2) parts that meet
    cost    : (border,) any unit
    parts   : how many there are
    returns : (tree border,) ascending
    """
    of = np.arange(parts)
    kept = []
    for row in np.argsort(cost, kind="stable"):
        a, b = of[pair[row]]
        if a != b:
            of[of == max(a, b)] = min(a, b)
            kept.append(row)
    return np.sort(np.array(kept, dtype=np.int64))


def rooted(pair: Ints, kept: Ints, area: Floats) -> RootedTree:
    """The tree, its root the part at which no branch has more than half of the body's area (ours).

    pair   : (border, 2) parts that meet
    kept   : (tree border,) borders of the tree
    area   : (part,) mesh unit²
    raises : ValueError where the borders do not join all parts
    """
    root = 0
    while True:
        tree = _rooted_at(pair, kept, root, len(area))
        branch = branch_area(tree, area)
        below = np.flatnonzero(tree.parents == 0)
        heavy = below[branch[below] > 0.5 * branch[0]]
        if not len(heavy):
            return tree
        root = int(tree.order[heavy[0]])


def branch_area(tree: RootedTree, area: Floats) -> Floats:
    """(part,) area of each part and all parts below it, mesh unit², in the tree's order; area : (part,) as numbered."""
    below = area[tree.order].astype(np.float64)
    for k in range(len(below) - 1, 0, -1):
        below[tree.parents[k]] += below[k]
    return below


def _rooted_at(pair: Ints, kept: Ints, root: int, parts: int) -> RootedTree:
    beside: list[list[tuple[int, int]]] = [[] for _ in range(parts)]
    for row in kept:
        a, b = int(pair[row, 0]), int(pair[row, 1])
        beside[a].append((b, int(row)))
        beside[b].append((a, int(row)))
    order, parents, border = [root], [-1], [-1]
    for place, part in enumerate(order):
        for other, row in beside[part]:
            if row != border[place]:
                order.append(other)
                parents.append(place)
                border.append(row)
    if len(order) < parts:
        raise ValueError(f"{parts - len(order)} parts meet no other part of the tree")
    return RootedTree(np.array(order), np.array(parents), np.array(border))
