"""The reference mesh as an embedded deformation graph: nodes, what each vertex follows, which nodes edges link.

After Sumner, Schmid and Pauly 2007, in place of the dense mapping of 2014, §5. Lengths are relative to the size of the
body, the square root of its area, which no pose changes. Nodes lie closer where the body is thin: a toe that turns needs
nodes on both sides of its joint, and limbs end thin.
"""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.nearest_nodes import nearest_nodes
from kinetree.tasks.numerics.geometry.neighbours import rings
from kinetree.tasks.numerics.geometry.normals import smoothed_normals
from kinetree.tasks.numerics.geometry.sampling import farthest_points
from kinetree.tasks.numerics.geometry.surface import Surface
from kinetree.tasks.numerics.geometry.thickness import opposite, thickness
from kinetree.tasks.numerics.registration.block_system import pattern

BOUND = 4
"""Nodes a vertex follows; the compiled assembly of the system is written for four."""


class DeformationGraphSettings(NamedTuple):
    """How finely the reference is covered, and which nodes edges link. Chosen on: not recorded where nothing else is said."""

    nodes: int
    """How many, fewer if the mesh has fewer vertices. With 1,400 a dancer keeps 0.83 instead of 0.80 of its turning and errs by
    0.257 to 0.275 % of its height, for 1.4 times the time."""
    finest: float
    """Spacing where the body is thinnest, share of the spacing where it is thick. With a quarter the dancer keeps 0.79."""
    thick: float
    """Thickness from which on the spacing no longer grows, share of √area."""
    strut: float
    """Edges link nodes on opposite sides, through the body, up to this thickness, share of √area."""
    samples: int
    """Vertices for each node that stand for the surface in a fit."""
    neighbours: int = 8
    """Nearest nodes to which edges lead from each node."""


@dataclass(frozen=True)
class DeformationGraph:
    """The rest shape of the body and its deformation graph.

    V, F   : (vertex, xyz) mesh unit · (face, corner)
    N      : (vertex, xyz) unit normals, smoothed
    node   : (node,) the vertex each node lies on, ascending
    bound  : (vertex, 4) the nodes a vertex follows, ascending along each row
    weight : (vertex, 4) not negative, each row sums to 1
    edge   : (edge, 2) nodes that an edge links, the smaller first, sorted
    sample : (sample,) vertices that stand for the surface in a fit, ascending
    size   : square root of the area, mesh unit
    start, ring : (vertex + 1,) · (entry,) neighbours over edges, see `rings`
    pair, of_vertex, of_edge : the blocks of the system that a fit solves, see `pattern`
    """

    V: Floats
    F: Ints
    N: Floats
    node: Ints
    bound: Ints
    weight: Floats
    edge: Ints
    sample: Ints
    size: float
    start: Ints
    ring: Ints
    pair: Ints
    of_vertex: Ints
    of_edge: Ints

    @property
    def g(self) -> Floats:
        """(node, xyz) where the nodes lie at rest, mesh unit."""
        return self.V[self.node]


def deformation_graph(V: Floats, F: npt.NDArray[np.integer[Any]], settings: DeformationGraphSettings) -> DeformationGraph:
    """Cover a reference mesh with nodes, bind its vertices to them and link neighbours by edges (after Sumner 2007).

    V, F    : (vertex, xyz) mesh unit · (face, corner) a clean mesh of any number of components
    returns : DeformationGraph, the same for the same mesh whatever the machine
    """
    faces = F.astype(np.int64)
    surface = Surface.of(V, F)
    size = float(np.sqrt(surface.area.sum()))
    N = smoothed_normals(V, F)
    spacing = _smoothed(np.clip(thickness(V, N, size) / (settings.thick * size), settings.finest, 1.0), faces)
    node = farthest_points(surface, spacing, settings.nodes)
    nearest, distance = nearest_nodes(surface, node, settings.neighbours + 1)
    bound, weight = bindings(nearest[:, : BOUND + 1], distance[:, : BOUND + 1])
    near = _pairs(np.repeat(np.arange(len(node)), settings.neighbours), nearest[node, 1:].ravel())
    through = _struts(V, N, size, node, nearest[:, 0], settings.strut)
    edge = np.unique(np.concatenate([near, through]), axis=0)
    sample = _samples(nearest[:, 0], distance[:, 0], len(node), settings.samples)
    blocks = pattern(bound, edge, len(node))
    wiring = *rings(faces, len(V)), *blocks
    return DeformationGraph(np.ascontiguousarray(V), faces, N, node, bound, weight, edge, sample, size, *wiring)


def bindings(nearest: Ints, distance: Floats) -> tuple[Ints, Floats]:
    """Nodes that each vertex follows, with weights (1 − d/d₅)² normalised  (Sumner 2007, Eq. 4).

    A vertex in a component with fewer nodes follows those there are; its row repeats one of them with weight 0.

    nearest  : (vertex, 5) nodes, nearest first, −1 where there is none
    distance : (vertex, 5) mesh unit, infinite where there is none
    returns  : (vertex, 4) ascending along each row · (vertex, 4) summing to 1
    """
    is_node = nearest[:, :BOUND] >= 0
    d = np.where(is_node, distance[:, :BOUND], 0.0)
    limit = np.where(np.isfinite(distance[:, BOUND]), distance[:, BOUND], 1.5 * d.max(axis=1))
    share = d / np.where(limit > 0, limit, 1.0)[:, None]
    weight = np.where(is_node, (1.0 - np.minimum(share, 1.0)) ** 2, 0.0)
    # as far from the fifth as from the first, or in a component without nodes: follow the first alone
    weight[:, 0] = np.where(weight.sum(axis=1) > 0, weight[:, 0], 1.0)
    bound = np.where(is_node, nearest[:, :BOUND], np.maximum(nearest[:, :1], 0))
    ascending = np.argsort(bound, axis=1, kind="stable")
    weight = np.take_along_axis(weight / weight.sum(axis=1, keepdims=True), ascending, axis=1)
    return np.take_along_axis(bound, ascending, axis=1), weight


def _smoothed(x: Floats, F: Ints, rounds: int = 4) -> Floats:
    """Averages over neighbours: one vertex that found no opposite point must not leave a gap among thin ones."""
    for _ in range(rounds):
        total, count = x.copy(), np.ones(len(x))
        for a, b in ((0, 1), (1, 2), (2, 0), (1, 0), (2, 1), (0, 2)):
            total += np.bincount(F[:, a], x[F[:, b]], len(x))
            count += np.bincount(F[:, a], minlength=len(x))
        x = total / count
    return x


def _pairs(a: Ints, b: Ints) -> Ints:
    """(pair, 2) the smaller first, without pairs of a node with itself or with none (−1)."""
    pair = np.sort(np.stack([a, b], axis=1), axis=1)
    return pair[(pair[:, 0] >= 0) & (pair[:, 0] < pair[:, 1])]


def _struts(V: Floats, N: Floats, size: float, node: Ints, cell: Ints, thickest: float) -> Ints:
    """(pair, 2) nodes linked through the body: without these edges a section bulges instead of turning."""
    across, length = opposite(V, N, size, node)
    inside = length.ravel() < thickest * size
    return _pairs(np.repeat(np.arange(len(node)), across.shape[1])[inside], cell[across.ravel()][inside])


def _samples(cell: Ints, distance: Floats, nodes: int, count: int) -> Ints:
    """(sample,) about the same number of vertices from each node's cell, spread from the node outwards."""
    order = np.lexsort((distance, cell))
    start = np.searchsorted(cell[order], np.arange(nodes + 1))
    size = np.diff(start)
    step = np.arange(count) * size[:, None] // count
    return np.unique(order[(start[:-1, None] + step)[size > 0]])
