"""The initial model: a graph inside the body as a tree of nodes, and the surface that follows them (2009, Sec. 2.3.1).

A node carries the piece of the surface that it stands for. It turns against the node before it about the middle of the edge
between them, which is inside the body as both ends are.
"""

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_array
from scipy.spatial import cKDTree

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.geometry.neighbours import rings
from kinetree.tasks.numerics.paper_2009.graph_loops import end_branches
from kinetree.tasks.numerics.structure.skinning import few, heaviest


class GraphBody(NamedTuple):
    """A tree of nodes, parents before children.

    node          : (node, xyz) mesh unit
    parents       : (node,) −1 for the root, the node with the largest piece
    joint         : (node, xyz) about which each turns: amid the edge to its parent; the root's is the root itself
    branch        : (node,) leaf at the end of the branch that each is on, −1 on the trunk
    end           : (leaf,) node that holds each leaf
    label         : (vertex,) node that carries it
    bound, weight : (vertex, 4) nodes it follows · how much, summing to 1
    """

    node: Floats
    parents: Ints
    joint: Floats
    branch: Ints
    end: Ints
    label: Ints
    bound: Ints
    weight: Floats


def graph_body(
    V: Floats,
    F: npt.NDArray[np.integer[Any]],
    node: Floats,
    edge: Ints,
    loop: Flags,
    area: Floats,
    end: Ints,
    of_vertex: Ints,
    smoothing: float = 0.3,
    spacing: float = 0.0,
) -> GraphBody:
    """The tree of a graph whose loops are opened; nodes without a piece of their own are left out.

    V, F            : (vertex, xyz) mesh unit · (face, corner)
    node, area      : (node, xyz) · (node,) · edge, loop : (edge, 2) · (edge,) whether it closes a loop
    end             : (leaf,) node · of_vertex : (vertex,) node, −1 for none
    smoothing       : width over which the surface blends between nodes, share of the distance between them
    spacing         : least distance of nodes along a chain, mesh unit; what is nearer goes with its neighbour
    """
    outwards, before = _tree(len(node), edge[~loop], area)
    stays = (area > 0.0) & _spaced(node, outwards, before, end, spacing)
    stays[end] = True
    order, above = _staying(outwards, before, stays)
    place = np.full(len(node), -1)
    place[order] = np.arange(len(order))
    parents = np.where(above >= 0, place[above], -1)
    carrier = _carriers(node, outwards, before, stays)
    place = np.where(carrier >= 0, place[np.maximum(carrier, 0)], -1)
    X = node[order]
    joint = np.where(parents[:, None] >= 0, (X + X[np.maximum(parents, 0)]) / 2, X)
    children = np.arange(1, len(order))
    links = np.stack([parents[children], children], axis=1)
    label = np.where(of_vertex >= 0, place[np.maximum(of_vertex, 0)], -1)
    missing = label < 0
    if missing.any():
        label[missing] = cKDTree(X).query(V[missing])[1]
    usual = float(np.median(np.linalg.norm(X[links[:, 0]] - X[links[:, 1]], axis=1))) if len(links) else 0.0
    bound, weight = heaviest(_blended(V, F, label, len(order), smoothing * usual))
    ends = place[end]
    return GraphBody(X, parents, joint, end_branches(len(order), links, ends), ends, label, bound, weight)


def _tree(count: int, edge: Ints, area: Floats) -> tuple[list[int], Ints]:
    """Nodes from the largest outwards, and (node,) the one before each; nodes out of reach are left out."""
    near: list[list[int]] = [[] for _ in range(count)]
    for a, b in edge.tolist():
        near[a].append(b)
        near[b].append(a)
    root = int(np.argmax(area))
    before = np.full(count, -1)
    order, reached = [root], {root}
    for n in order:
        for m in sorted(near[n]):
            if m not in reached:
                reached.add(m)
                before[m] = n
                order.append(m)
    return order, before


def _spaced(node: Floats, order: list[int], before: Ints, end: Ints, least: float) -> Flags:
    """(node,) whether a node stays when those of a chain are to be so far from each other; ends and branch points stay."""
    children = np.bincount(before[order][before[order] >= 0], minlength=len(node))
    fixed = children != 1
    fixed[order[0]] = fixed[end] = True
    stays, last = np.ones(len(node), np.bool_), np.arange(len(node))
    for n in order[1:]:
        above = int(last[before[n]])
        if np.linalg.norm(node[n] - node[above]) >= least:
            continue
        if not fixed[n]:
            stays[n], last[n] = False, above
        elif not fixed[above]:
            stays[above] = False
    return stays


def _carriers(node: Floats, order: list[int], before: Ints, stays: Flags) -> Ints:
    """(node,) the node that takes each node's piece: itself, or the nearer of those that stay before and behind it."""
    up, down = np.full(len(node), -1), np.full(len(node), -1)
    for n in order:
        up[n] = n if stays[n] else up[before[n]] if before[n] >= 0 else -1
    for n in reversed(order):
        down[n] = n if stays[n] else down[n]
        if before[n] >= 0 and not stays[before[n]] and down[n] >= 0:
            down[before[n]] = down[n]
    far = [np.linalg.norm(node - node[np.maximum(way, 0)], axis=1) + np.where(way < 0, np.inf, 0.0) for way in (up, down)]
    return np.where(far[0] <= far[1], up, down)


def _staying(order: list[int], before: Ints, stays: Flags) -> tuple[Ints, Ints]:
    """The nodes that stay, in the same order · (node,) the one before each among them."""
    staying = [n for n in order if stays[n]]
    above = []
    for n in staying:
        p = int(before[n])
        while p >= 0 and not stays[p]:
            p = int(before[p])
        above.append(p)
    return np.array(staying, np.int64), np.array(above, np.int64)


def _blended(V: Floats, F: npt.NDArray[np.integer[Any]], label: Ints, count: int, width: float) -> Floats:
    """(vertex, node) labels averaged over neighbours until they blend over a width, at most four nodes a vertex."""
    start, ring = rings(np.array(F, np.int64), len(V))
    degree = np.diff(start)
    edge = float(np.linalg.norm(V[np.repeat(np.arange(len(V)), degree)] - V[ring], axis=1).mean()) if len(ring) else 1.0
    share = csr_array((np.repeat(0.5 / np.maximum(degree, 1), degree), ring, start), shape=(len(V), len(V)))
    W = csr_array((np.ones(len(V)), (np.arange(len(V)), label)), shape=(len(V), count))
    for _ in range(min(int(np.ceil(2.0 * (width / max(edge, 1e-300)) ** 2)), 40)):
        W = share @ W + 0.5 * W
    dense = W.toarray()
    dense[dense.sum(axis=1) <= 0.0, 0] = 1.0
    return few(dense / dense.sum(axis=1, keepdims=True))
