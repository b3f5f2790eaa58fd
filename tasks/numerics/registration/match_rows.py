"""Matches of one Gauss–Newton step: which of them count, by how much, and what they add to the energy.

Each match is looked at once, and nothing is written that does not count; the same numbers as with whole arrays, in less time.
"""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.compiled import compiled

_LEAST_COSINE = 0.5
"""Matches whose normals have a smaller cosine do not count; with 0.3 a dancer and a wolf keep the same turning."""


class MatchRows(NamedTuple):
    """Matches that count in one step.

    vertex   : (row,) of the body
    other    : (row,) of the frame
    residual : (row, xyz) x − y, mesh unit
    normal   : (row, xyz) of the plane halfway between both normals, unit
    plane    : (row,) weight of the squared distance from the plane
    """

    vertex: Ints
    other: Ints
    residual: Floats
    normal: Floats
    plane: Floats


@compiled
def match_rows(
    x: Floats, n: Floats, V: Floats, N: Floats, vertex: Ints, other: Ints, reach: float, scale: float, share: float
) -> tuple[Ints, Ints, Floats, Floats, Floats]:
    """Matches nearer than `reach`, weighted share · (n·m) / (1 + (distance from the plane / scale)²)²; see `MatchRows`.

    Planes are halfway between both normals: then matches that are not quite opposite cost nothing on a round surface
    (Rusinkiewicz 2019).

    x, n          : (vertex, xyz) the body, mesh unit · (vertex, xyz) unit
    V, N          : (vertex, xyz) the frame, mesh unit · (vertex, xyz) unit
    vertex, other : (match,) of the body and of the frame
    reach, scale  : mesh unit
    share         : what one match counts
    """
    of_body, of_frame = np.empty(len(vertex), np.int64), np.empty(len(vertex), np.int64)
    residual, normal, plane = np.empty((len(vertex), 3)), np.empty((len(vertex), 3)), np.empty(len(vertex))
    row = 0
    for i in range(len(vertex)):
        v, u = vertex[i], other[i]
        r0, r1, r2 = x[v, 0] - V[u, 0], x[v, 1] - V[u, 1], x[v, 2] - V[u, 2]
        n0, n1, n2, m0, m1, m2 = n[v, 0], n[v, 1], n[v, 2], N[u, 0], N[u, 1], N[u, 2]
        alike = n0 * m0 + n2 * m2 + n1 * m1
        if not alike > _LEAST_COSINE or not r0 * r0 + r2 * r2 + r1 * r1 < reach * reach:
            continue
        h0, h1, h2 = m0 + n0, m1 + n1, m2 + n2
        length = max(np.sqrt(h0 * h0 + h1 * h1 + h2 * h2), np.finfo(np.float64).tiny)
        h0, h1, h2 = h0 / length, h1 / length, h2 / length
        off = r0 * h0 + r2 * h2 + r1 * h1
        far = 1.0 + (off / scale) ** 2
        of_body[row], of_frame[row], plane[row] = v, u, share * alike / (far * far)
        residual[row, 0], residual[row, 1], residual[row, 2] = r0, r1, r2
        normal[row, 0], normal[row, 1], normal[row, 2] = h0, h1, h2
        row += 1
    return of_body[:row].copy(), of_frame[:row].copy(), residual[:row].copy(), normal[:row].copy(), plane[:row].copy()


@compiled
def row_energies(residual: Floats, normal: Floats, plane: Floats, nearness: Floats) -> tuple[Floats, Floats]:
    """(row,) plane · (n·r)² · (row,) nearness · |r|², mesh unit²; arguments as in `MatchRows`, nearness : (row,)."""
    of_plane, of_distance = np.empty(len(plane)), np.empty(len(plane))
    for i in range(len(plane)):
        r0, r1, r2 = residual[i, 0], residual[i, 1], residual[i, 2]
        off = r0 * normal[i, 0] + r2 * normal[i, 2] + r1 * normal[i, 1]
        of_plane[i] = plane[i] * (off * off)
        of_distance[i] = nearness[i] * (r0 * r0 + r2 * r2 + r1 * r1)
    return of_plane, of_distance


@compiled
def residuals(x: Floats, vertex: Ints, V: Floats, other: Ints) -> Floats:
    """(row, xyz) x − y of every match, mesh unit; arguments as in `match_rows`."""
    out = np.empty((len(vertex), 3))
    for i in range(len(vertex)):
        for k in range(3):
            out[i, k] = x[vertex[i], k] - V[other[i], k]
    return out
