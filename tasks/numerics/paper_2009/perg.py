"""Pseudo endoskeleton Reeb graph: a Reeb graph whose nodes and edges lie inside the body (2009, Sec. 2.1, Fig. 1).

A node, or both ends of an edge, outside the surface is replaced by the nodes of the next finer level that it is made of, again
and again. What is outside even at the finest level is moved inside (ours), or stays (the paper's letter).
"""

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.geometry.closest_point import projected
from kinetree.tasks.numerics.geometry.inside import crossed, depth_along, inside
from kinetree.tasks.numerics.paper_2009.graph_loops import closing_edges, pruned
from kinetree.tasks.numerics.paper_2009.reeb_graph import ReebGraph, active_nodes

BENDS = 4
"""Rounds in which an edge that leaves the body at the finest level is bent at its middle; each halves it."""


class Perg(NamedTuple):
    """A graph inside the body.

    node      : (node, xyz) mesh unit
    level     : (node,) level of the Reeb graph that it comes from; −1 for a node at which an edge was bent
    height    : (node,) middle of its bands, share of the range of μ
    area      : (node,) of its pieces, mesh unit²
    edge      : (edge, 2) nodes that meet
    loop      : (edge,) whether it closes a loop
    end       : (leaf,) node that holds each leaf
    of_vertex : (vertex,) the node whose piece holds it, or that its pruned piece hangs on; −1 in no face
    outside   : (edge,) whether the edge or one of its ends leaves the body
    reach     : (loop,) share of the range of μ that each loop spans, longest first
    replaced  : nodes that were replaced by finer ones
    """

    node: Floats
    level: Ints
    height: Floats
    area: Floats
    edge: Ints
    loop: Flags
    end: Ints
    of_vertex: Ints
    outside: Flags
    reach: Floats
    replaced: int


def perg(
    V: Floats,
    F: npt.NDArray[np.integer[Any]],
    graph: ReebGraph,
    leaves: Ints,
    *,
    start: int = 2,
    least_loop: float = 0.05,
    moved_inside: bool = True,
    prune: bool = True,
) -> Perg:
    """The graph of one frame, its nodes and edges inside the surface.

    V, F         : (vertex, xyz) mesh unit · (face, corner) closed
    graph        : of all levels
    leaves       : (leaf,) vertices at the ends of limbs; without any the graph is a single node
    start        : level with which the replacement begins, 0 the finest
    least_loop   : share of the range of μ that a loop spans at least; a shorter one is opened at its narrowest contour
    moved_inside : whether what is outside at the finest level is moved inside
    prune        : whether branches that hold no leaf are removed
    """
    own, replaced = _replaced(V, F, graph, np.full(int((graph.level == 0).sum()), start))
    nodes, own = np.unique(own, return_inverse=True)
    own = own.reshape(-1).astype(np.int64)
    edge, contour = _edges_of(own, graph)
    top = int(graph.level.max())
    height = (graph.band[nodes] + 0.5) / 2.0 ** (top - graph.level[nodes])
    end = own[graph.of_vertex[leaves]]
    length = np.full(len(edge), 1.0)
    closing, reach = closing_edges(len(nodes), edge, length, height)
    keep = ~closing | (reach > least_loop)
    edge, contour, closing, reach = edge[keep], contour[keep], closing[keep], reach[keep]
    hangs_on = pruned(len(nodes), edge, end, graph.area[nodes]) if prune else np.arange(len(nodes))
    remaining, number = np.unique(hangs_on, return_inverse=True)
    number = number.reshape(-1).astype(np.int64)
    inner = (hangs_on[edge] == edge).all(axis=1)
    edge, contour, closing, reach = number[edge[inner]], contour[inner], closing[inner], reach[inner]
    of_vertex = np.where(graph.of_vertex >= 0, number[own[np.maximum(graph.of_vertex, 0)]], -1)
    area = np.bincount(number, graph.area[nodes], len(remaining)).astype(np.float64)
    body = _Drawn(graph.centre[nodes][remaining], graph.level[nodes][remaining], height[remaining], area, edge, closing)
    if moved_inside:
        body = _bent(V, F, body, contour)
    return Perg(
        *body[:4], body.edge, body.loop, number[end], of_vertex, leaving(V, F, body.node, body.edge),
        np.sort(reach[closing])[::-1], replaced,
    )  # fmt: skip


def leaving(V: Floats, F: npt.NDArray[np.integer[Any]], node: Floats, edge: Ints) -> Flags:
    """(edge,) whether an edge, or one of its ends, is not inside the surface."""
    within = inside(node, V, F)
    out = ~within[edge].all(axis=1) if len(edge) else np.zeros(0, np.bool_)
    return np.asarray(out | crossed(node[edge[:, 0]], node[edge[:, 1]], V, F))


class _Drawn(NamedTuple):
    node: Floats
    level: Ints
    height: Floats
    area: Floats
    edge: Ints
    loop: Flags


def _replaced(V: Floats, F: npt.NDArray[np.integer[Any]], graph: ReebGraph, level: Ints) -> tuple[Ints, int]:
    """(finest node,) the node that stands for it, after replacing what is outside · how many were replaced."""
    own, count = active_nodes(graph, int(level[0])) if len(level) else level, 0
    fine = [active_nodes(graph, k) for k in range(int(graph.level.max()) + 1)]
    while True:
        nodes = np.unique(own)
        within = np.ones(len(graph.level), np.bool_)
        within[nodes] = inside(graph.centre[nodes], V, F)
        edge, _ = _edges_of(own, graph)
        leaves = ~within[edge].all(axis=1) | crossed(graph.centre[edge[:, 0]], graph.centre[edge[:, 1]], V, F)
        wrong = np.zeros(len(graph.level), np.bool_)
        wrong[nodes[~within[nodes]]] = True
        wrong[edge[leaves].ravel()] = True
        wrong &= graph.level > 0
        if not wrong.any():
            return own, count
        count += int(wrong.sum())
        for k in range(1, len(fine)):
            here = wrong[own] & (graph.level[own] == k)
            own = np.where(here, fine[k - 1], own)


def _edges_of(own: Ints, graph: ReebGraph) -> tuple[Ints, Floats]:
    """(edge, 2) pairs of standing nodes that meet · (edge, xyz) mean of the contours between them."""
    link = own[graph.edge]
    apart = link[:, 0] != link[:, 1]
    edge, row = np.unique(np.sort(link[apart], axis=1), axis=0, return_inverse=True)
    row = row.reshape(-1)
    count = np.maximum(np.bincount(row, minlength=len(edge)), 1)
    points = [np.bincount(row, graph.contour[apart, x], len(edge)) / count for x in range(3)]
    return edge.reshape(-1, 2).astype(np.int64), np.stack(points, axis=1)


def _bent(V: Floats, F: npt.NDArray[np.integer[Any]], body: _Drawn, contour: Floats) -> _Drawn:
    """Nodes outside moved inside; edges that leave the body bent at their contour, then at their middles."""
    node, level, height, area, edge, loop = body
    node = moved_inside(node, V, F)
    for round_ in range(BENDS):
        bad = np.flatnonzero(crossed(node[edge[:, 0]], node[edge[:, 1]], V, F))
        if not len(bad):
            break
        middle = contour[bad] if round_ == 0 else node[edge[bad]].mean(axis=1)
        new = len(node) + np.arange(len(bad))
        node = np.concatenate([node, moved_inside(middle, V, F)])
        level = np.concatenate([level, np.full(len(bad), -1)])
        height = np.concatenate([height, height[edge[bad]].mean(axis=1)])
        area = np.concatenate([area, np.zeros(len(bad))])
        beyond = np.stack([new, edge[bad, 1]], axis=1)
        edge = edge.copy()
        edge[bad, 1] = new
        edge, loop = np.concatenate([edge, beyond]), np.concatenate([loop, np.zeros(len(bad), np.bool_)])
        contour = np.concatenate([contour, contour[bad]])
    return _Drawn(node, level, height, area, edge, loop)


def moved_inside(P: Floats, V: Floats, F: npt.NDArray[np.integer[Any]]) -> Floats:
    """Points outside the surface moved to halfway between the nearest point of it and the surface behind that."""
    out = np.array(P, np.float64)
    bad = np.flatnonzero(~inside(out, V, F))
    if len(bad):
        at = projected(out[bad], V, F)
        corner = V[F[at.face]]
        foot = np.einsum("pcx,pc->px", corner, at.share)
        normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
        normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), np.finfo(float).tiny)
        size = float(np.linalg.norm(np.ptp(V, axis=0)))
        depth = depth_along(foot, -normal, V, F, 1e-6 * size)
        out[bad] = foot - np.where(np.isfinite(depth), depth / 2, 1e-4 * size)[:, None] * normal
    return out
