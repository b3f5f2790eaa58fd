"""Deliberately too many parts, to eliminate from: optimal runs of rings in the cones, merged patches elsewhere."""

from typing import NamedTuple

import numpy as np
from scipy.sparse.csgraph import dijkstra

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.geometry.geodesic_distance import geodesic_distance
from kinetree.tasks.numerics.geometry.neighbours import edge_lengths, ring_edges
from kinetree.tasks.numerics.geometry.rigid_fit import moments
from kinetree.tasks.numerics.geometry.sampling import farthest_points
from kinetree.tasks.numerics.geometry.surface import Surface
from kinetree.tasks.numerics.structure.leaf_cones import cones
from kinetree.tasks.numerics.structure.optimal_runs import merge_growth, runs
from kinetree.tasks.numerics.structure.patch_merging import merged

NO_CONE = -1
"""`ConeRuns.cone` where there is no cone."""
SHARED = -2
"""`ConeRuns.cone` where several cones lie and no leaf is much nearer than the others."""


class OversegmentationSettings(NamedTuple):
    """How finely cones and patches are cut; lengths are shares of the root of the area, areas shares of it."""

    rings: int
    """Rings in the longest distance from each leaf. Not recorded; more rings follow thin limbs more closely."""
    patches: int
    """Patches that the whole surface is cut into. Not recorded."""
    cut: float = 0.002
    """Root mean square residual that makes a tenth of a cone's rings worth a run of their own. Not recorded."""
    shortest_run: int = 2
    """Rings in a run at least. Not recorded; a single ring is flat, and its rotation badly known."""
    clearly_nearer: float = 0.7
    """Distance from a leaf, share of that from any other, below which a vertex of several cones counts in that leaf's cone.
    Chosen on generated humans, where cones reach round the trunk and up the next leg."""
    pocket: float = 0.1
    """Area of a side branch without a leaf that a cone absorbs. Not recorded; beyond it the cone ends there."""
    trunk_groups: int = 16
    """Groups that the patches outside the cones are merged into at first. Not recorded."""
    split: float = 1e-7
    """Growth of the mean squared residual, times area, from which on patches of one run or group stay apart. Not recorded."""


class ConeRuns(NamedTuple):
    """The cones around the leaves, and the rigid runs that their rings are cut into.

    label : (vertex,) rigid run, numbered over all cones, −1 outside the cones
    cone  : (vertex,) cone in which a vertex counts, `NO_CONE`, or `SHARED`
    ring  : (vertex,) its ring there, 0 around the leaf, −1 outside
    run   : (cone, ring) run of each ring within its cone, ascending from 0; −1 beyond the cone's last ring
    merge : (cone, ring) merge error at each ring's far border, mesh unit; NaN from the cone's last ring on
    """

    label: Ints
    cone: Ints
    ring: Ints
    run: Ints
    merge: Floats


def cone_runs(
    surface: Surface,
    V: Floats,
    x: Floats,
    weight: Floats,
    leaves: Ints,
    start: Ints,
    ring: Ints,
    settings: OversegmentationSettings,
) -> ConeRuns:
    """Rings around every leaf, cut into rigid runs (2014, Sec. 6.1.1 and 6.1.2; the optimal cut is ours).

    surface     : its lengths may be in another unit than the rest
    V, x        : (vertex, xyz) · (frame, vertex, xyz) mesh unit, near the origin
    weight      : (frame, vertex) confidence times area
    leaves      : (leaf,) vertices
    start, ring : neighbours of every vertex
    """
    chosen = settings
    outside = np.full(len(V), -1, np.int64)
    shape = (len(leaves), chosen.rings)
    out = ConeRuns(outside, outside.copy(), outside.copy(), np.full(shape, -1, np.int64), np.full(shape, np.nan))
    if not len(leaves):
        return out
    distance = geodesic_distance(surface, leaves)
    extent = cones(distance, surface.area, leaves, start, ring, chosen.rings, chosen.pocket)
    out.cone[:] = _cone_of_vertices(distance, extent, chosen.clearly_nearer)
    total = 0
    for k, rings_of_cone in enumerate(extent):
        own = np.where(out.cone == k, rings_of_cone, -1)
        inside = own >= 0
        if not inside.any():
            continue
        M = moments(V, x, weight, own, int(own.max()) + 1)
        run, merge = _cut(M, np.bincount(own[inside], minlength=len(M)) > 0, len(x), chosen)
        out.label[inside] = total + run[own[inside]]
        out.ring[inside] = own[inside]
        out.run[k, : len(run)], out.merge[k, : len(merge)] = run, merge
        total += int(run.max()) + 1
    return out


def _cut(M: Floats, occupied: Flags, frames: int, chosen: OversegmentationSettings) -> tuple[Ints, Floats]:
    """(ring,) run of every ring of a cone · (ring − 1,) merge error of its far border, mesh unit; NaN beside an empty ring.

    The merge error is √(Δ / m): Δ the growth of the rigid residual when the tenth of the rings before a border and the tenth
    behind it become one, m the frames times a fifth of the rings' usual mass. The optimal cut pays cut² m for a run, so two
    such tenths alone are cut where the error is above `cut`.
    """
    mass = M[:, :, 0].mean(axis=1)
    usual = float(np.median(mass[occupied]))
    run = runs(M, frames * chosen.cut**2 * usual * chosen.rings / 5, chosen.shortest_run)
    growth = merge_growth(M, max(chosen.rings // 10, chosen.shortest_run))
    unit = frames * usual * chosen.rings / 5
    known = occupied[1:] & occupied[:-1] & (unit > 0.0)
    return run, np.where(known, np.sqrt(growth / (unit or 1.0)), np.nan)


def _cone_of_vertices(distance: Floats, extent: Ints, clearly_nearer: float) -> Ints:
    """(vertex,) the cone in which each vertex counts: its only one, or that of a leaf much nearer than all others.

    distance, extent : (leaf, vertex) from each leaf · ring of each vertex, −1 beyond the cone
    returns          : cone, `NO_CONE` or `SHARED`
    """
    nearest = np.where(extent >= 0, distance, np.inf).argmin(axis=0)
    row = np.arange(distance.shape[1])
    own = distance[nearest, row]
    others = distance.copy()
    others[nearest, row] = np.inf
    count = (extent >= 0).sum(axis=0)
    clear = (count == 1) | ((count > 1) & (own < clearly_nearer * others.min(axis=0)))
    return np.where(clear, nearest, np.where(count > 1, SHARED, NO_CONE))


def patches(surface: Surface, V: Floats, start: Ints, ring: Ints, count: int) -> Ints:
    """(vertex,) patch of the surface, of about equal size: the nearest of farthest points.

    V           : (vertex, xyz) mesh unit
    start, ring : neighbours of every vertex
    count       : patches
    """
    centre = farthest_points(surface, np.ones(len(V)), count)
    graph = edge_lengths(V, ring_edges(start, ring))
    nearest: Ints = dijkstra(graph, indices=centre, return_predecessors=True, min_only=True)[2]
    return np.unique(nearest, return_inverse=True)[1].reshape(-1)


def grouped(
    V: Floats, x: Floats, weight: Floats, patch: Ints, label: Ints, start: Ints, ring: Ints, least: int, limit: float
) -> Ints:
    """Patches, cut along the borders of labels, merged within each label while they move as one.

    V, x        : (vertex, xyz) · (frame, vertex, xyz) mesh unit
    weight      : (frame, vertex) confidence times area
    patch       : (vertex,) see `patches`
    label       : (vertex,) −1 for vertices that belong to no group
    start, ring : neighbours of every vertex
    least       : groups to leave at least
    limit       : growth of the residual beyond which nothing is merged, mesh unit² times weight, summed over frames
    returns     : (vertex,) group, −1 where label is
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
    to = merged(M, pairs, least, limit)
    return np.where(group >= 0, to[group], -1)
