"""The body's surface in every frame, as far as an evaluation needs it: its size, and how thick it is at a joint."""

import numpy as np
import numpy.typing as npt
from scipy.spatial import KDTree

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Indices = npt.NDArray[np.integer]
LEAST_INSIDE = 0.5
LEAST_SPAN = 0.2


def skinned(V: Floats, influence: Indices, weight: Floats, rest: Floats, R: Floats, X: Floats) -> Floats:
    """One frame's surface, x(v) = Σ_i w_vi [R_i (v − rest_i) + x_i].

    V                 : (vertex, xyz) reference mesh, mesh unit
    influence, weight : (vertex, k) joints each vertex follows, and how much
    rest, X           : (joint, xyz) joints in the reference and in the frame, mesh unit
    R                 : (joint, 3, 3) from the reference to the frame
    returns           : (vertex, xyz) mesh unit
    """
    turned = np.einsum("vkab,vkb->vka", R[influence], V[:, None] - rest[influence]) + X[influence]
    return np.asarray(np.einsum("vk,vka->va", weight, turned))


def side(V: Floats) -> float:
    """Longest side of the bounding box, mesh unit: the edge of the cube into which the body fits."""
    return float(np.ptp(V, axis=0).max())


def inside(V: Floats, points: Floats, margin: float = 0.1) -> float:
    """Share of the points that lie in the bounding box of V grown by `margin` of its diagonal to all sides.

    V, points : (vertex, xyz), (point, xyz) mesh unit
    """
    low, high = V.min(axis=0), V.max(axis=0)
    reach = margin * np.linalg.norm(high - low)
    return float(((points >= low - reach) & (points <= high + reach)).all(axis=1).mean())


def fits(V: Floats, points: Floats) -> bool:
    """Whether points can be the joints of a body: half of them in its box at least, and spanning a fifth of its size.

    V, points : (vertex, xyz), (point, xyz) mesh unit
    """
    return inside(V, points) >= LEAST_INSIDE and side(points) >= LEAST_SPAN * side(V)


def radii(V: Floats, points: Floats) -> Floats:
    """(point,) distance to the nearest vertex, mesh unit: half the local diameter at a point in the middle of a limb."""
    return np.asarray(KDTree(V).query(points)[0], dtype=np.float64)


def nearest(V: Floats, points: Floats) -> Ints:
    """(point,) the vertex nearest to each point."""
    return np.asarray(KDTree(V).query(points)[1], dtype=np.int64)
