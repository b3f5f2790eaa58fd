"""The nearest point of a surface, as a face and its three shares: how labels come back, and how well two meshes agree.

Faces stand in a tree of boxes (Ericson 2005, Sec. 6.6.2), built along a Morton curve. Points are asked for along the same
curve, so that what one has found bounds the search of the next.
"""

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.geometry.morton_curve import morton_order

_LEAF = 4
"""Faces in one box of the tree's last level; 2 and 8 take a tenth longer."""
_DEPTH = 64
"""Safety bound: boxes that wait while one is searched, one a level of the tree."""


class Projection(NamedTuple):
    """Points on a surface.

    face     : (point,) face on which each lies
    share    : (point, corner) barycentric, not negative, summing to 1
    distance : (point,) mesh unit
    """

    face: Ints
    share: Floats
    distance: Floats


class SurfaceTree(NamedTuple):
    """A surface that is asked for its nearest points several times: its faces along a Morton curve and the boxes above them.

    triangle : (face, corner, xyz) in the order of the leaves, mesh unit
    order    : (face,) their numbers
    box      : (node, 6) see `_boxes`
    """

    triangle: Floats
    order: Ints
    box: Floats

    @staticmethod
    def of(V: Floats, F: npt.NDArray[np.integer[Any]]) -> "SurfaceTree":
        """The tree of V (vertex, xyz), mesh unit, and F (face, corner), at least one face; those without area are accepted."""
        corners = np.asarray(V, np.float64)[F]
        order = morton_order(corners.mean(axis=1))
        triangle = np.ascontiguousarray(corners[order])
        return SurfaceTree(triangle, order, _boxes(triangle))

    def nearest(self, P: Floats) -> Projection:
        """The nearest points of the surface to P (point, xyz), as `projected` gives them."""
        points = np.ascontiguousarray(P, np.float64)
        return Projection(*_nearest(points, morton_order(points), self.triangle, self.order, self.box))


def projected(P: Floats, V: Floats, F: npt.NDArray[np.integer[Any]]) -> Projection:
    """The nearest point of all faces; of faces equally near, the first  (Ericson 2005, Sec. 5.1.5 for one triangle).

    P       : (point, xyz) mesh unit
    V, F    : (vertex, xyz) mesh unit · (face, corner), at least one face; those without area are accepted
    returns : Projection
    """
    return SurfaceTree.of(V, F).nearest(P)


@compiled
def _boxes(triangle: Floats) -> Floats:
    """(node, 6) least and greatest coordinates of a full binary tree: node i is above 2 i and 2 i + 1, the root is 1.

    triangle : (face, corner, xyz) in the order of the leaves, `_LEAF` to each
    """
    leaves = 1
    while leaves * _LEAF < len(triangle):
        leaves *= 2
    box = np.empty((2 * leaves, 6))
    box[:, :3], box[:, 3:] = np.inf, -np.inf
    for k in range(len(triangle)):
        own = box[leaves + k // _LEAF]
        for corner in range(3):
            for x in range(3):
                own[x] = min(own[x], triangle[k, corner, x])
                own[3 + x] = max(own[3 + x], triangle[k, corner, x])
    for node in range(leaves - 1, 0, -1):
        for x in range(3):
            box[node, x] = min(box[2 * node, x], box[2 * node + 1, x])
            box[node, 3 + x] = max(box[2 * node, 3 + x], box[2 * node + 1, 3 + x])
    return box


@compiled
def _nearest(P: Floats, along: Ints, triangle: Floats, order: Ints, box: Floats) -> tuple[Ints, Floats, Floats]:
    """Face, shares and distance of every point, asked for in the order `along`; triangles are numbered by `order`."""
    face, share, distance = np.zeros(len(P), np.int64), np.zeros((len(P), 3)), np.empty(len(P))
    leaves, last = len(box) // 2, 0
    waiting, bound = np.empty(_DEPTH, np.int64), np.empty(_DEPTH)
    for i in along:
        x, y, z = P[i, 0], P[i, 1], P[i, 2]
        least, v, w = _to_triangle(x, y, z, triangle, last)
        waiting[0], bound[0], top = 1, 0.0, 1
        while top > 0:
            top -= 1
            node, away = waiting[top], bound[top]
            while away <= least and node < leaves:
                near, far = 2 * node, 2 * node + 1
                away, farther = _to_box(x, y, z, box, near), _to_box(x, y, z, box, far)
                if farther < away:
                    near, far, away, farther = far, near, farther, away
                if farther <= least:
                    waiting[top], bound[top] = far, farther
                    top += 1
                node = near
            if away <= least:
                first = (node - leaves) * _LEAF
                for k in range(first, min(first + _LEAF, len(triangle))):
                    d, b, c = _to_triangle(x, y, z, triangle, k)
                    if d < least or (d == least and order[k] < order[last]):
                        least, v, w, last = d, b, c, k
        face[i], distance[i] = order[last], np.sqrt(least)
        share[i, 0], share[i, 1], share[i, 2] = 1.0 - v - w, v, w
    return face, share, distance


@compiled
def _to_box(x: float, y: float, z: float, box: Floats, node: int) -> float:
    """Squared distance of a point to a box; infinite to one with nothing in it."""
    dx = max(box[node, 0] - x, x - box[node, 3], 0.0)
    dy = max(box[node, 1] - y, y - box[node, 4], 0.0)
    dz = max(box[node, 2] - z, z - box[node, 5], 0.0)
    return dx * dx + dy * dy + dz * dz


@compiled
def _to_triangle(x: float, y: float, z: float, triangle: Floats, k: int) -> tuple[float, float, float]:
    """Squared distance of a point to triangle k, and the shares of its second and third corner at the nearest point."""
    ax, ay, az = triangle[k, 0, 0], triangle[k, 0, 1], triangle[k, 0, 2]
    ux, uy, uz = triangle[k, 1, 0] - ax, triangle[k, 1, 1] - ay, triangle[k, 1, 2] - az
    wx, wy, wz = triangle[k, 2, 0] - ax, triangle[k, 2, 1] - ay, triangle[k, 2, 2] - az
    px, py, pz = x - ax, y - ay, z - az
    d1, d2 = ux * px + uy * py + uz * pz, wx * px + wy * py + wz * pz
    uu, uw, ww = ux * ux + uy * uy + uz * uz, ux * wx + uy * wy + uz * wz, wx * wx + wy * wy + wz * wz
    v, w = _shares(d1, d2, d1 - uu, d2 - uw, d1 - uw, d2 - ww)
    dx, dy, dz = px - v * ux - w * wx, py - v * uy - w * wy, pz - v * uz - w * wz
    return dx * dx + dy * dy + dz * dz, v, w


@compiled
def _shares(d1: float, d2: float, d3: float, d4: float, d5: float, d6: float) -> tuple[float, float]:
    """Shares of b and c at the point of triangle a, b, c nearest to p: (b − a)·(p − x) and (c − a)·(p − x) for x = a, b, c."""
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
