"""Patches of a surface merged as long as they move as one (Ward 1963, on the residual of rigid motion; ours)."""

import heapq

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.geometry.rigid_fit import MOMENTS, residual


def merged(M: Floats, pairs: Ints, count: int, limit: float = np.inf) -> Ints:
    """Neighbouring patches joined, the pair whose residual grows least first.

    M       : (patch, frame, 17) sums of every patch; see `rigid_fit.MOMENTS`
    pairs   : (pair, 2) patches that touch
    count   : groups to leave; patches that do not touch stay apart, however many there are
    limit   : growth of the residual beyond which nothing is joined, mesh unit² times weight, summed over frames
    returns : (patch,) group of each, numbered from 0 by the smallest patch
    """
    sums = M.copy()
    own = costs(sums)
    near: list[set[int]] = [set() for _ in range(len(sums))]
    for a, b in pairs.tolist():
        if a != b:
            near[a].add(b)
            near[b].add(a)
    version = [0] * len(sums)
    queue: list[tuple[float, int, int, int, int]] = []
    _offer(queue, sums, own, version, np.array([(a, b) for a in range(len(sums)) for b in sorted(near[a]) if a < b], np.int64))
    group = np.arange(len(sums))
    left = len(sums)
    while queue and left > count:
        growth, a, b, va, vb = heapq.heappop(queue)
        if growth > limit:
            break
        if version[a] != va or version[b] != vb:
            continue
        sums[a] += sums[b]
        own[a] = costs(sums[a : a + 1])[0]
        version[a] += 1
        version[b] = -1
        near[a] = (near[a] | near[b]) - {a, b}
        for c in near[b]:
            near[c].discard(b)
        for c in near[a]:
            near[c].add(a)
        group[group == b] = a
        left -= 1
        _offer(queue, sums, own, version, np.array([(a, c) for c in sorted(near[a])], np.int64))
    number: Ints = np.unique(group, return_inverse=True)[1].reshape(-1)
    return number


def _offer(queue: list[tuple[float, int, int, int, int]], sums: Floats, own: Floats, version: list[int], pairs: Ints) -> None:
    """Puts the growth of the residual of pairs on the queue, with the versions of both that it holds for."""
    if not len(pairs):
        return
    for (a, b), together in zip(pairs.tolist(), _union_costs(sums, pairs).tolist(), strict=True):
        heapq.heappush(queue, (together - own[a] - own[b], a, b, version[a], version[b]))


@compiled
def costs(M: Floats) -> Floats:
    """(set,) Σ over frames of the rigid residual of every set, mesh unit² times weight; M (set, frame, 17)."""
    out = np.zeros(len(M))
    for k in range(len(M)):
        for t in range(M.shape[1]):
            out[k] += residual(M[k, t])
    return out


@compiled
def _union_costs(M: Floats, pairs: Ints) -> Floats:
    """(pair,) cost of the union of two sets each."""
    out = np.zeros(len(pairs))
    m = np.empty(MOMENTS)
    for p in range(len(pairs)):
        a, b = pairs[p, 0], pairs[p, 1]
        for t in range(M.shape[1]):
            for k in range(MOMENTS):
                m[k] = M[a, t, k] + M[b, t, k]
            out[p] += residual(m)
    return out
