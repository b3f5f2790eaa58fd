"""Deliberately too many parts, to eliminate from: optimal runs of rings in the cones, merged patches elsewhere."""

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.covering import covering
from kinetree.tasks.numerics.geometry.geodesic_distance import geodesic_distance
from kinetree.tasks.numerics.geometry.rigid_moments import moments
from kinetree.tasks.numerics.geometry.surface import Surface
from kinetree.tasks.numerics.structure.leaf_cones import cones
from kinetree.tasks.numerics.structure.optimal_runs import runs
from kinetree.tasks.numerics.structure.patch_merging import merged

LEAST = 2  # rings in a run
NEAR = 0.7
"""Distance from a leaf, as a share of that from any other, below which what lies in several cones counts in its own."""


def cone_runs(
    surface: Surface, V: Floats, x: Floats, weight: Floats, leaves: Ints, start: Ints, ring: Ints, count: int, cut: float
) -> Ints:
    """Rigid runs of rings around every leaf.

    surface     : its lengths may be in another unit than the rest
    V, x        : (vertex, xyz) · (frame, vertex, xyz) mesh unit, near the origin
    weight      : (frame, vertex) belief times area
    leaves      : (leaf,) vertices
    start, ring : neighbours of every vertex
    count       : rings in the longest distance from each leaf
    cut         : root mean square residual that makes a tenth of the rings worth a run of their own, mesh unit
    returns     : (vertex,) run, −1 where there is no cone, or several and no leaf is much nearer than the others
    """
    label = np.full(len(V), -1, np.int64)
    if not len(leaves):
        return label
    away = geodesic_distance(surface, leaves, exact=0.0)
    C = cones(away, surface.area, leaves, start, ring, count)
    nearest = _whose(away, C)
    total = 0
    for k, cone in enumerate(C):
        own = np.where(nearest == k, cone, -1)
        mine = own >= 0
        if not mine.any():
            continue
        M = moments(V, x, weight, own, int(own.max()) + 1)
        held = M[:, :, 0].mean(axis=1)
        usual = float(np.median(held[np.bincount(own[mine], minlength=len(M)) > 0]))
        run = runs(M, len(x) * cut**2 * usual * count / 5, LEAST)
        label[mine] = total + run[own[mine]]
        total += int(run.max()) + 1
    return label


def _whose(distance: Floats, cone: Ints) -> Ints:
    """(vertex,) the cone in which each vertex counts, −1 for none: its only one, or that of a leaf much nearer than all others.

    distance, cone : (leaf, vertex) from each leaf · ring of each vertex, −1 beyond the cone
    """
    nearest = np.where(cone >= 0, distance, np.inf).argmin(axis=0)
    row = np.arange(distance.shape[1])
    own = distance[nearest, row]
    others = distance.copy()
    others[nearest, row] = np.inf
    held = (cone >= 0).sum(axis=0)
    clear = (held == 1) | ((held > 1) & (own < NEAR * others.min(axis=0)))
    return np.where(clear, nearest, -1)


def patches(surface: Surface, V: Floats, start: Ints, ring: Ints, count: int) -> Ints:
    """(vertex,) patch of the surface, of about equal size: the nearest of farthest points."""
    node = covering(surface, np.ones(len(V)), count)
    tail = np.repeat(np.arange(len(V)), np.diff(start))
    length = np.linalg.norm(V[tail] - V[ring], axis=1)
    way = csr_array((length, ring, start), shape=(len(V), len(V)))
    nearest: Ints = dijkstra(way, indices=node, return_predecessors=True, min_only=True)[2]
    return np.unique(nearest, return_inverse=True)[1].reshape(-1)


def grouped(
    V: Floats, x: Floats, weight: Floats, patch: Ints, label: Ints, start: Ints, ring: Ints, left: int, limit: float
) -> Ints:
    """Pieces of patches that lie in one label, merged within it while they move as one.

    weight  : (frame, vertex) belief times area
    patch   : (vertex,) see `patches`
    label   : (vertex,) −1 for what is left out
    left    : groups to leave at least
    limit   : growth of the residual beyond which nothing is merged, mesh unit² times weight, summed over frames
    returns : (vertex,) group, −1 where label is
    """
    if not (label >= 0).any():
        return label
    code = np.where(label >= 0, label * (patch.max() + 1) + patch, -1)
    used, group = np.unique(code, return_inverse=True)
    group = group.reshape(-1) - (used[0] < 0)
    count = int(group.max()) + 1
    M = moments(V, x, weight, group, count)
    tail = np.repeat(np.arange(len(V)), np.diff(start))
    same = (label[tail] == label[ring]) & (label[tail] >= 0) & (group[tail] < group[ring])
    pairs = np.unique(np.stack([group[tail], group[ring]], axis=1)[same], axis=0)
    to = merged(M, pairs, left, limit)
    return np.where(group >= 0, to[group], -1)
