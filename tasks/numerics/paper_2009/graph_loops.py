"""Loops of a graph and branches without an end, simplified before its topology is judged (ours, for 2009, Sec. 2.2).

On carved hulls most graphs have loops that span a few bands only; they say nothing of contact.
"""

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints


def closing_edges(count: int, edge: Ints, weight: Floats, height: Floats) -> tuple[Flags, Floats]:
    """(edge,) whether it closes a loop of heavier edges · (edge,) that loop's reach, 0 where it closes none.

    count  : nodes
    weight : (edge,) heavier edges are kept
    height : (node,) the reach of a loop is the range of its nodes' heights
    """
    tree: list[list[int]] = [[] for _ in range(count)]
    closing, reach = np.zeros(len(edge), np.bool_), np.zeros(len(edge))
    root = np.arange(count)
    for e in np.argsort(-weight, kind="stable"):
        a, b = (int(n) for n in edge[e])
        if root[a] != root[b]:
            root[root == root[b]] = root[a]
            tree[a].append(b)
            tree[b].append(a)
        else:
            way = path(tree, a, b)
            closing[e], reach[e] = True, float(np.ptp(height[way]))
    return closing, reach


def path(tree: list[list[int]], a: int, b: int) -> list[int]:
    """Nodes from a to b along a tree of neighbours; a alone where no path leads to b."""
    before, waiting = {a: a}, [a]
    for n in waiting:
        if n == b:
            break
        for m in tree[n]:
            if m not in before:
                before[m] = n
                waiting.append(m)
    way = [b if b in before else a]
    while way[-1] != a:
        way.append(before[way[-1]])
    return way


def pruned(count: int, edge: Ints, ends: Ints, area: Floats) -> Ints:
    """(node,) the node that each hangs on after removing branches that lead to no end and are in no loop; itself if it stays.

    ends : (leaf,) nodes that stay
    area : (node,) without ends and loops the largest node is what stays
    """
    near: list[set[int]] = [set() for _ in range(count)]
    for a, b in edge.tolist():
        near[a].add(b)
        near[b].add(a)
    fixed = set(ends.tolist()) or {int(np.argmax(area))}
    hangs_on = np.arange(count)
    waiting = [n for n in range(count) if len(near[n]) < 2 and n not in fixed]
    for n in waiting:
        for m in near[n]:
            hangs_on[n] = m
            near[m].discard(n)
            if len(near[m]) < 2 and m not in fixed:
                waiting.append(m)
        near[n] = set()
    while (hangs_on[hangs_on] != hangs_on).any():
        hangs_on = hangs_on[hangs_on]
    return hangs_on


def branch_degrees(count: int, edge: Ints) -> tuple[int, ...]:
    """Number of edges at each branch point, those of three and more, the most first."""
    degree = np.bincount(edge.ravel(), minlength=count)
    return tuple(sorted((int(d) for d in degree if d > 2), reverse=True))


def end_branches(count: int, edge: Ints, ends: Ints) -> Ints:
    """(node,) leaf whose branch each node is on: from its end to before the first branch point; −1 on the trunk."""
    near: list[list[int]] = [[] for _ in range(count)]
    for a, b in edge.tolist():
        near[a].append(b)
        near[b].append(a)
    branch = np.full(count, -1)
    for leaf, n in enumerate(ends.tolist()):
        before, here = -1, n
        while len(near[here]) <= 2 and branch[here] < 0:
            branch[here] = leaf
            onward = [m for m in near[here] if m != before]
            if not onward:
                break
            before, here = here, onward[0]
    return branch


def branch_length(node: Floats, edge: Ints, branch: Ints, ends: Ints) -> float:
    """Geometric mean of the lengths of the branches, each from its end to the branch point, mesh unit; 0 without ends.

    node : (node, xyz) mesh unit · edge : (edge, 2) · branch : (node,) see `end_branches` · ends : (leaf,) nodes
    """
    long = np.linalg.norm(node[edge[:, 0]] - node[edge[:, 1]], axis=1)
    on = np.maximum(branch[edge[:, 0]], branch[edge[:, 1]])
    own = np.bincount(on[on >= 0], long[on >= 0], len(ends))
    return float(np.exp(np.log(np.maximum(own, np.finfo(float).tiny)).mean())) if len(ends) else 0.0
