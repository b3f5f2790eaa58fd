"""The body's surface in one frame, as an evaluation needs it: its position, its size, its thickness at a joint."""

import numpy as np
import numpy.typing as npt
from scipy.spatial import KDTree

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.results.evaluation.settings import EvaluationSettings

Numbers = npt.NDArray[np.integer]
"""Indices of joints, of any integer type."""


def blended_skin(V: Floats, influence: Numbers, weight: Floats, rest: Floats, R: Floats, X: Floats) -> Floats:
    """The surface in one frame by linear blend skinning, x(v) = Σ_i w_vi [R_i (v − rest_i) + x_i].

    V         : (vertex, xyz) reference mesh, mesh unit
    influence : (vertex, slot) joints that each vertex follows
    weight    : (vertex, slot) how much it follows each, rows sum to 1
    rest      : (joint, xyz) joints in the reference pose, mesh unit
    R         : (joint, 3, 3) rotation of each joint from the reference pose to the frame
    X         : (joint, xyz) joints in the frame, mesh unit
    returns   : (vertex, xyz) mesh unit
    """
    rotated = np.einsum("vkab,vkb->vka", R[influence], V[:, None] - rest[influence]) + X[influence]
    return np.asarray(np.einsum("vk,vka->va", weight, rotated))


def longest_side(V: Floats) -> float:
    """Longest side of the bounding box, which is the side of the cube into which the body fits.

    V       : (vertex, xyz) mesh unit
    returns : mesh unit
    """
    return float(np.ptp(V, axis=0).max())


def share_inside(V: Floats, points: Floats, margin: float) -> float:
    """Share of the points that lie in the enlarged bounding box of V.

    V       : (vertex, xyz) mesh unit
    points  : (point, xyz) mesh unit
    margin  : by how much the box is enlarged on every side, share of its diagonal
    returns : 0 to 1
    """
    low, high = V.min(axis=0), V.max(axis=0)
    reach = margin * np.linalg.norm(high - low)
    return float(((points >= low - reach) & (points <= high + reach)).all(axis=1).mean())


def joints_fit(V: Floats, points: Floats, settings: EvaluationSettings | None = None) -> bool:
    """Whether points can be the joints of a body: enough of them lie in its box, and they span enough of its size (ours).

    V        : (vertex, xyz) surface of the body in a frame, mesh unit
    points   : (point, xyz) joints in the same frame, mesh unit
    settings : box_margin, least_inside and least_span are used
    """
    limit = settings or EvaluationSettings()
    inside = share_inside(V, points, limit.box_margin) >= limit.least_inside
    return inside and longest_side(points) >= limit.least_span * longest_side(V)


def local_radii(V: Floats, points: Floats) -> Floats:
    """Distance from each point to the nearest vertex: half the body's local diameter where the point is amid a limb.

    V       : (vertex, xyz) mesh unit
    points  : (point, xyz) mesh unit
    returns : (point,) mesh unit
    """
    return np.asarray(KDTree(V).query(points)[0], dtype=np.float64)


def nearest_vertices(V: Floats, points: Floats) -> Ints:
    """The vertex nearest to each point.

    V       : (vertex, xyz) mesh unit
    points  : (point, xyz) mesh unit
    returns : (point,) index of a vertex
    """
    return np.asarray(KDTree(V).query(points)[1], dtype=np.int64)
