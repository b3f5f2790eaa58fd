"""The nearest point of a surface, as a face and its three shares: how labels come back, and how well two meshes agree."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.compiled import compiled


class Projection(NamedTuple):
    """Points on a surface.

    face     : (point,) face on which each lies
    share    : (point, corner) barycentric, not negative, summing to 1
    distance : (point,) mesh unit
    """

    face: Ints
    share: Floats
    distance: Floats


def projected(P: Floats, V: Floats, F: npt.NDArray[np.integer], candidates: int = 4) -> Projection:
    """The nearest point on the triangles around the nearest vertices (Ericson 2005, Sec. 5.1.5, for one triangle).

    A face much larger than its neighbours may be missed when none of its corners is among the nearest vertices.

    P          : (point, xyz) mesh unit
    V, F       : (vertex, xyz) · (face, corner)
    candidates : nearest vertices whose faces are tried
    """
    used = np.unique(F)
    count = min(candidates, len(used))
    near = used[cKDTree(V[used]).query(P, k=count)[1].reshape(len(P), count)]
    corner = np.argsort(F.ravel(), kind="stable")
    start = np.searchsorted(F.ravel()[corner], np.arange(len(V) + 1))
    return Projection(*_nearest(P, V, np.ascontiguousarray(F, np.int64), near, start, corner // 3))


@compiled
def _nearest(P: Floats, V: Floats, F: Ints, near: Ints, start: Ints, around: Ints) -> tuple[Ints, Floats, Floats]:
    face, share, distance = np.zeros(len(P), np.int64), np.zeros((len(P), 3)), np.full(len(P), np.inf)
    for i in range(len(P)):
        for k in range(near.shape[1]):
            for e in range(start[near[i, k]], start[near[i, k] + 1]):
                f = around[e]
                v, w = _shares(P[i], V[F[f, 0]], V[F[f, 1]], V[F[f, 2]])
                d = 0.0
                for x in range(3):
                    d += (P[i, x] - (1.0 - v - w) * V[F[f, 0], x] - v * V[F[f, 1], x] - w * V[F[f, 2], x]) ** 2
                if d < distance[i]:
                    distance[i], face[i] = d, f
                    share[i, 0], share[i, 1], share[i, 2] = 1.0 - v - w, v, w
    return face, share, np.sqrt(distance)


@compiled
def _shares(p: Floats, a: Floats, b: Floats, c: Floats) -> tuple[float, float]:
    """Barycentric shares of b and c at the point of the triangle nearest to p."""
    d1 = d2 = d3 = d4 = d5 = d6 = 0.0
    for x in range(3):
        ab, ac = b[x] - a[x], c[x] - a[x]
        d1 += ab * (p[x] - a[x])
        d2 += ac * (p[x] - a[x])
        d3 += ab * (p[x] - b[x])
        d4 += ac * (p[x] - b[x])
        d5 += ab * (p[x] - c[x])
        d6 += ac * (p[x] - c[x])
    if d1 <= 0 and d2 <= 0:
        return 0.0, 0.0
    if d3 >= 0 and d4 <= d3:
        return 1.0, 0.0
    if d6 >= 0 and d5 <= d6:
        return 0.0, 1.0
    vc = d1 * d4 - d3 * d2
    if vc <= 0 and d1 >= 0 and d3 <= 0:
        return (d1 / (d1 - d3) if d1 > d3 else 0.0), 0.0
    vb = d5 * d2 - d1 * d6
    if vb <= 0 and d2 >= 0 and d6 <= 0:
        return 0.0, (d2 / (d2 - d6) if d2 > d6 else 0.0)
    va = d3 * d6 - d5 * d4
    if va <= 0 and d4 >= d3 and d5 >= d6:
        w = (d4 - d3) / (d4 - d3 + d5 - d6) if d4 - d3 + d5 - d6 > 0 else 0.0
        return 1.0 - w, w
    total = va + vb + vc
    if not total > 0:
        return 0.0, 0.0
    return vb / total, vc / total
