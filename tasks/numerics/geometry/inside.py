"""Whether points and straight lines lie inside a closed surface: by the crossings of a ray, and by crossings of the line."""

from typing import Any

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.compiled import compiled

_DIRECTIONS = np.array([[0.3571, 0.2113, 0.9099], [0.8711, -0.4313, 0.2347], [-0.1847, 0.9131, -0.3635]])
"""Rays in general position; where a surface has small holes, two of three decide."""
_ROUNDING = 1e-12
"""By what a line may miss a triangle, share of its edges: else one through an edge may slip between two triangles."""


def inside(P: Floats, V: Floats, F: npt.NDArray[np.integer[Any]]) -> Flags:
    """(point,) whether each point is inside: two of three rays leave the surface more often than they enter it.

    P    : (point, xyz) mesh unit
    V, F : (vertex, xyz) mesh unit · (face, corner) closed, outside counter-clockwise
    """
    faces = np.ascontiguousarray(F, np.int64)
    first, second = (_leaves(P, V, faces, direction) for direction in _DIRECTIONS[:2])
    undecided = np.flatnonzero(first != second)
    if len(undecided):
        first[undecided] = _leaves(P[undecided], V, faces, _DIRECTIONS[2])
    return first


def crossed(A: Floats, B: Floats, V: Floats, F: npt.NDArray[np.integer[Any]]) -> Flags:
    """(line,) whether the straight line from a to b meets the surface.

    A, B : (line, xyz) mesh unit
    V, F : as for `inside`
    """
    ends = np.ascontiguousarray(A), np.ascontiguousarray(B)
    return _crossed(*ends, np.ascontiguousarray(V), np.ascontiguousarray(F, np.int64))


def depth_along(P: Floats, D: Floats, V: Floats, F: npt.NDArray[np.integer[Any]], least: float) -> Floats:
    """(point,) distance along a direction to the first face beyond `least`, mesh unit; infinite where there is none.

    P, D : (point, xyz) mesh unit · (point, xyz) unit
    """
    rays = np.ascontiguousarray(P), np.ascontiguousarray(D)
    return _depth(*rays, np.ascontiguousarray(V), np.ascontiguousarray(F, np.int64), least)


def _frame(direction: Floats) -> Floats:
    """(3, 3) a rotation that takes a direction to the third axis."""
    z = direction / np.linalg.norm(direction)
    x = np.cross(z, [0.0, 0.0, 1.0] if abs(z[2]) < 0.9 else [1.0, 0.0, 0.0])
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z])


def _leaves(P: Floats, V: Floats, F: Ints, direction: Floats) -> Flags:
    """(point,) whether a ray in a direction leaves the surface more often than it enters it."""
    A = _frame(direction)
    return np.asarray(_crossings(np.ascontiguousarray(P @ A.T), np.ascontiguousarray(V @ A.T), F) > 0)


@compiled
def _crossings(P: Floats, V: Floats, F: Ints) -> Ints:
    """(point,) how often a ray along the third axis leaves the surface, less how often it enters."""
    out = np.zeros(len(P), np.int64)
    along = np.argsort(P[:, 0])
    first = P[along, 0]
    for f in range(len(F)):
        a, b, c = V[F[f, 0]], V[F[f, 1]], V[F[f, 2]]
        x0, x1 = min(a[0], b[0], c[0]), max(a[0], b[0], c[0])
        y0, y1 = min(a[1], b[1], c[1]), max(a[1], b[1], c[1])
        top = max(a[2], b[2], c[2])
        area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        if area == 0.0:
            continue
        for k in range(np.searchsorted(first, x0), len(P)):
            i, x, y = along[k], P[along[k], 0], P[along[k], 1]
            if x > x1:
                break
            if y < y0 or y > y1 or P[i, 2] > top:
                continue
            u = ((b[0] - x) * (c[1] - y) - (b[1] - y) * (c[0] - x)) / area
            v = ((c[0] - x) * (a[1] - y) - (c[1] - y) * (a[0] - x)) / area
            w = 1.0 - u - v
            if u >= 0.0 and v >= 0.0 and w >= 0.0 and u * a[2] + v * b[2] + w * c[2] > P[i, 2]:
                out[i] += 1 if area > 0.0 else -1
    return out


@compiled
def _hit(p: Floats, d: Floats, a: Floats, b: Floats, c: Floats) -> float:
    """Where p + s d meets a triangle, as s; −1 where it does not (Möller, Trumbore 1997)."""
    e0, e1, e2 = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    g0, g1, g2 = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    h0, h1, h2 = d[1] * g2 - d[2] * g1, d[2] * g0 - d[0] * g2, d[0] * g1 - d[1] * g0
    det = e0 * h0 + e1 * h1 + e2 * h2
    if det == 0.0:
        return -1.0
    s0, s1, s2 = p[0] - a[0], p[1] - a[1], p[2] - a[2]
    u = (s0 * h0 + s1 * h1 + s2 * h2) / det
    q0, q1, q2 = s1 * e2 - s2 * e1, s2 * e0 - s0 * e2, s0 * e1 - s1 * e0
    v = (d[0] * q0 + d[1] * q1 + d[2] * q2) / det
    if u < -_ROUNDING or v < -_ROUNDING or u + v > 1.0 + _ROUNDING:
        return -1.0
    return (g0 * q0 + g1 * q1 + g2 * q2) / det


@compiled
def _crossed(A: Floats, B: Floats, V: Floats, F: Ints) -> Flags:
    out = np.zeros(len(A), np.bool_)
    low, high = np.empty((len(F), 3)), np.empty((len(F), 3))
    for f in range(len(F)):
        for x in range(3):
            low[f, x] = min(V[F[f, 0], x], V[F[f, 1], x], V[F[f, 2], x])
            high[f, x] = max(V[F[f, 0], x], V[F[f, 1], x], V[F[f, 2], x])
    for i in range(len(A)):
        l0, l1, l2 = min(A[i, 0], B[i, 0]), min(A[i, 1], B[i, 1]), min(A[i, 2], B[i, 2])
        m0, m1, m2 = max(A[i, 0], B[i, 0]), max(A[i, 1], B[i, 1]), max(A[i, 2], B[i, 2])
        d = B[i] - A[i]
        for f in range(len(F)):
            if l0 > high[f, 0] or m0 < low[f, 0] or l1 > high[f, 1] or m1 < low[f, 1] or l2 > high[f, 2] or m2 < low[f, 2]:
                continue
            s = _hit(A[i], d, V[F[f, 0]], V[F[f, 1]], V[F[f, 2]])
            if 0.0 <= s <= 1.0:
                out[i] = True
                break
    return out


@compiled
def _depth(P: Floats, D: Floats, V: Floats, F: Ints, least: float) -> Floats:
    out = np.full(len(P), np.inf)
    for i in range(len(P)):
        for f in range(len(F)):
            s = _hit(P[i], D[i], V[F[f, 0]], V[F[f, 1]], V[F[f, 2]])
            if least < s < out[i]:
                out[i] = s
    return out
