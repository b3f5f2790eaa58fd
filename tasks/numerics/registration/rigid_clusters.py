"""Nodes of the deformation graph that have moved as one: clusters merged in pairs, always the two that cost the least.

The cost of a cluster is the residual if one rigid motion in each frame carries all its nodes, Σ_j m_j |R g_j + c − p_j|² with
m = 1/spacing²: relative bending, so that a finger counts as much as a thigh. After Ward 1963; the residual is closed form.
"""

import heapq
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.geometry.rigid_fit import rotation_gain
from kinetree.tasks.numerics.registration.deformation import Pose
from kinetree.tasks.numerics.registration.deformation_graph import DeformationGraph

_Offer = tuple[float, int, int, int, int, tuple[float, ...]]


class RigidClustersSettings(NamedTuple):
    """How much a cluster may bend, and how far a node reaches."""

    cost: float = 1.0
    """Two clusters stay two if merging them costs more than this in a frame, spacings². Chosen on: not recorded."""
    neighbours: int = 4
    """Nearest nodes whose mean distance is the spacing around a node. Chosen on: not recorded."""
    extent: float = 0.5
    """A node stands for points this far from it on three axes, spacings; so its rotation counts. Chosen on: not recorded."""
    longest: float = 2.5
    """Longer edges, such as those through the body, merge no clusters, spacings. Chosen on: not recorded."""


class _Moments(NamedTuple):
    """Moments of every cluster: mass m, Σ m g, Σ m |g|², and in every frame Σ m p, Σ m |p|², Σ m p gᵀ."""

    M: Floats
    G: Floats
    gg: Floats
    P: Floats
    pp: Floats
    C: Floats


def rigid_clusters(
    graph: DeformationGraph,
    poses: Sequence[Pose],
    settings: RigidClustersSettings | None = None,
    *,
    takes: Sequence[slice] | None = None,
) -> Ints:
    """Which nodes have moved as one rigid body in all frames (ours, after Ward 1963).

    graph   : of the reference mesh
    poses   : (frame,) those of a take in any order; at least one
    takes   : positions of the frames of each take, of which the dearest decides; None takes all as one
    returns : (node,) number of the cluster, in the order of each cluster's first node
    """
    settings = settings or RigidClustersSettings()
    spacing = _spacing(graph.g, settings.neighbours)
    moments = _moments(graph, poses, spacing, settings.extent)
    length = np.linalg.norm(graph.g[graph.edge[:, 0]] - graph.g[graph.edge[:, 1]], axis=1)
    near = graph.edge[length < settings.longest * spacing[graph.edge].max(axis=1)]
    begins = np.array([take.start for take in takes] if takes else [0])
    label = _merged(moments, near, np.append(begins, len(poses)), settings.cost)
    return np.unique(label, return_inverse=True)[1].astype(np.int64)


def _spacing(g: Floats, neighbours: int) -> Floats:
    """(node,) mean distance to the nearest nodes; 1 for a node alone or in one place with them."""
    count = min(neighbours + 1, len(g))
    distance = cKDTree(g).query(g, count)[0].reshape(len(g), count)[:, 1:]
    mean = distance.mean(axis=1) if count > 1 else np.ones(len(g))
    return np.where(mean > 0, mean, 1.0)


def _moments(graph: DeformationGraph, poses: Sequence[Pose], spacing: Floats, extent: float) -> _Moments:
    """Moments of single nodes; positions are relative to the middle of the body, against cancellation."""
    middle = graph.g.mean(axis=0)
    g = graph.g - middle
    m, spread = 1.0 / spacing**2, (extent * spacing) ** 2
    P = np.stack([pose.translation - middle for pose in poses], axis=1)
    R = np.stack([pose.rotation for pose in poses], axis=1)
    own = 3.0 * spread
    C = m[:, None, None, None] * (P[:, :, :, None] * g[:, None, None, :] + spread[:, None, None, None] * R)
    pp = m[:, None] * ((P * P).sum(axis=2) + own[:, None])
    return _Moments(m.copy(), m[:, None] * g, m * ((g * g).sum(axis=1) + own), m[:, None, None] * P, pp, C)


def _merged(moments: _Moments, edge: Ints, borders: Ints, limit: float) -> Ints:
    """(node,) the first node of its cluster; `moments` is changed in place.

    borders : (take + 1,) first frame of each take, and how many frames there are
    limit   : of what two clusters may cost
    """
    nodes = len(moments.M)
    label, own, version = np.arange(nodes), np.zeros((nodes, len(borders) - 1)), np.zeros(nodes, np.int64)
    around: list[set[int]] = [set() for _ in range(nodes)]
    for a, b in edge.tolist():
        around[a].add(b)
        around[b].add(a)
    waiting = [_offer(_merged_cost(a, b, borders, *moments), a, b, 0, 0) for a, b in edge.tolist()]
    heapq.heapify(waiting)
    while waiting:
        cost, a, b, version_a, version_b, growth = heapq.heappop(waiting)
        if version[a] != version_a or version[b] != version_b:
            continue
        if cost > limit:
            break
        own[a] += own[b] + growth
        for moment in moments:
            moment[a] += moment[b]
        label[label == b] = a
        version[a], version[b] = version[a] + 1, -1
        around[a] = (around[a] | around[b]) - {a, b}
        for k in sorted(around[a]):
            around[k] = (around[k] - {b}) | {a}
            first, second = min(a, k), max(a, k)
            more = _merged_cost(first, second, borders, *moments) - own[a] - own[k]
            heapq.heappush(waiting, _offer(more, first, second, int(version[first]), int(version[second])))
    return label


def _offer(growth: Floats, a: int, b: int, version_a: int, version_b: int) -> _Offer:
    """Two clusters, by what merging them costs in the dearest take; growth : (take,) of the mean residual."""
    return float(growth.max()), a, b, version_a, version_b, tuple(growth.tolist())


@compiled
def _merged_cost(a: int, b: int, borders: Ints, M: Floats, G: Floats, gg: Floats, P: Floats, pp: Floats, C: Floats) -> Floats:
    """(take,) mean residual if a and b move as one; summed in sorted order, so that the order of frames does not matter."""
    out = np.empty(len(borders) - 1)
    H = np.empty((3, 3))
    mass = M[a] + M[b]
    rest = gg[a] + gg[b]
    for x in range(3):
        rest -= (G[a, x] + G[b, x]) ** 2 / mass
    for k in range(len(out)):
        residual = np.empty(borders[k + 1] - borders[k])
        for i in range(len(residual)):
            t = borders[k] + i
            posed = pp[a, t] + pp[b, t]
            for x in range(3):
                shift = (P[a, t, x] + P[b, t, x]) / mass
                posed -= shift * shift * mass
                for y in range(3):
                    H[x, y] = C[a, t, x, y] + C[b, t, x, y] - shift * (G[a, y] + G[b, y])
            residual[i] = max(rest + posed - 2.0 * rotation_gain(H), 0.0)
        residual.sort()
        out[k] = residual.mean()
    return out
