"""Pieces of the deformation graph that have moved as one: nodes merged pairwise, always the two that cost the least.

The cost of a piece is what is left when one rigid motion a frame carries all its nodes, Σ_j m_j |R g_j + c − p_j|² with
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

ONE = 1.0  # two pieces stay two if together they cost more than this a frame, spacings squared
_AROUND = 4  # nearest nodes that tell the spacing
_EXTENT = 0.5  # a node stands for points this many spacings around it, which turn with it
_FAR = 2.5  # ties longer than so many spacings join no pieces


class _Moments(NamedTuple):
    """Of every piece: mass, Σ m g, Σ m |g|², (piece, frame, …) Σ m p, Σ m |p|², Σ m p gᵀ."""

    M: Floats
    G: Floats
    gg: Floats
    P: Floats
    pp: Floats
    C: Floats


def rigid_clusters(graph: DeformationGraph, poses: Sequence[Pose], limit: float = ONE) -> Ints:
    """Which nodes have moved as one piece in all frames.

    poses   : one a frame, in any order; at least one
    limit   : cost above which pieces are not merged
    returns : (node,) number of the piece, in the order of each piece's first node
    """
    spacing = _spacing(graph.g)
    moments = _moments(graph, poses, spacing)
    length = np.linalg.norm(graph.g[graph.edge[:, 0]] - graph.g[graph.edge[:, 1]], axis=1)
    near = graph.edge[length < _FAR * spacing[graph.edge].max(axis=1)]
    label = _merged(moments, near, limit)
    return np.unique(label, return_inverse=True)[1].astype(np.int64)


def _spacing(g: Floats) -> Floats:
    """(node,) mean distance to the nearest nodes; 1 for a node alone or in one place with them."""
    count = min(_AROUND + 1, len(g))
    distance = cKDTree(g).query(g, count)[0].reshape(len(g), count)[:, 1:]
    mean = distance.mean(axis=1) if count > 1 else np.ones(len(g))
    return np.where(mean > 0, mean, 1.0)


def _moments(graph: DeformationGraph, poses: Sequence[Pose], spacing: Floats) -> _Moments:
    """Of every node by itself; places are taken from the middle of the body, against cancellation."""
    middle = graph.g.mean(axis=0)
    g = graph.g - middle
    m, spread = 1.0 / spacing**2, (_EXTENT * spacing) ** 2
    P = np.stack([pose.translation - middle for pose in poses], axis=1)
    R = np.stack([pose.rotation for pose in poses], axis=1)
    own = 3.0 * spread
    C = m[:, None, None, None] * (P[:, :, :, None] * g[:, None, None, :] + spread[:, None, None, None] * R)
    pp = m[:, None] * ((P * P).sum(axis=2) + own[:, None])
    return _Moments(m.copy(), m[:, None] * g, m * ((g * g).sum(axis=1) + own), m[:, None, None] * P, pp, C)


def _merged(moments: _Moments, edge: Ints, limit: float) -> Ints:
    """(node,) the first node of its piece; `moments` is changed in place."""
    nodes = len(moments.M)
    label, own, version = np.arange(nodes), np.zeros(nodes), np.zeros(nodes, np.int64)
    around: list[set[int]] = [set() for _ in range(nodes)]
    for a, b in edge.tolist():
        around[a].add(b)
        around[b].add(a)
    waiting = [(_joined(a, b, *moments), a, b, 0, 0) for a, b in edge.tolist()]
    heapq.heapify(waiting)
    while waiting:
        cost, a, b, seen_a, seen_b = heapq.heappop(waiting)
        if version[a] != seen_a or version[b] != seen_b:
            continue
        if cost > limit:
            break
        own[a] += own[b] + cost
        for moment in moments:
            moment[a] += moment[b]
        label[label == b] = a
        version[a], version[b] = version[a] + 1, -1
        around[a] = (around[a] | around[b]) - {a, b}
        for k in sorted(around[a]):
            around[k] = (around[k] - {b}) | {a}
            first, second = min(a, k), max(a, k)
            more = _joined(first, second, *moments) - own[a] - own[k]
            heapq.heappush(waiting, (more, first, second, int(version[first]), int(version[second])))
    return label


@compiled
def _joined(a: int, b: int, M: Floats, G: Floats, gg: Floats, P: Floats, pp: Floats, C: Floats) -> float:
    """What is left, a frame, when a and b move as one piece; sorted, so that the order of frames does not matter."""
    left = np.empty(P.shape[1])
    H = np.empty((3, 3))
    mass = M[a] + M[b]
    rest = gg[a] + gg[b]
    for x in range(3):
        rest -= (G[a, x] + G[b, x]) ** 2 / mass
    for t in range(len(left)):
        posed = pp[a, t] + pp[b, t]
        for x in range(3):
            shift = (P[a, t, x] + P[b, t, x]) / mass
            posed -= shift * shift * mass
            for y in range(3):
                H[x, y] = C[a, t, x, y] + C[b, t, x, y] - shift * (G[a, y] + G[b, y])
        left[t] = max(rest + posed - 2.0 * rotation_gain(H), 0.0)
    left.sort()
    return left.mean()
