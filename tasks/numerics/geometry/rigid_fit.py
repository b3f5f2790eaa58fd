"""Rigid fits: the motion x ≈ R q + t of least Σ w |R q + t − x|², from points or from their sums (Horn 1987; Kabsch 1976).

The sums of two disjoint sets add up to those of their union. So the residual of any run of rings, or of any two patches
together, costs the same however many vertices they have.
"""

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.geometry.quaternion_matrix import (
    adjugate_eigenvector,
    jacobi_eigenvector,
    largest_root,
    quaternion_matrix,
    write_rotation,
)

MOMENTS = 17
"""Numbers a set and frame: mass, Σ q, Σ x, Σ (|q|² + |x|²), Σ q xᵀ by rows."""


def nearest_rotation(H: Floats) -> Floats:
    """The rotation R with the largest tr(Rᵀ H), reflections left out, by singular values  (Kabsch 1976).

    H       : (…, 3, 3) Σ w x qᵀ, where rotating q should give x; any unit
    returns : (…, 3, 3)
    """
    U, _, Vt = np.linalg.svd(H)
    U[..., 2] *= np.sign(np.linalg.det(U @ Vt))[..., None]
    return np.asarray(U @ Vt, dtype=np.float64)


@compiled
def nearest_rotations(H: Floats) -> Floats:
    """The same as `nearest_rotation` for many matrices, as eigenvectors of their quaternion matrices  (Horn 1987).

    H       : (matrix, 3, 3) any unit
    returns : (matrix, 3, 3)
    """
    R = np.empty_like(H)
    for i in range(len(H)):
        write_rotation(jacobi_eigenvector(quaternion_matrix(H[i])), R[i])
    return R


def rigid_motion(Q: Floats, X: Floats, weight: Floats | None = None) -> tuple[Floats, Floats]:
    """The rigid motion that carries Q nearest to X, in least squares  (Kabsch 1976).

    Q, X    : (…, point, xyz) mesh unit, point by point the same
    weight  : (…, point) not negative, above 0 in sum; None counts all alike
    returns : R (…, 3, 3) · t (…, xyz) mesh unit, so that X ≈ Q Rᵀ + t
    """
    if weight is None:
        q, x = Q.mean(axis=-2), X.mean(axis=-2)
        H = (X - x[..., None, :]).swapaxes(-1, -2) @ (Q - q[..., None, :])
    else:
        share = weight[..., None] / weight.sum(axis=-1)[..., None, None]
        q, x = (share * Q).sum(axis=-2), (share * X).sum(axis=-2)
        H = (share * (X - x[..., None, :])).swapaxes(-1, -2) @ (Q - q[..., None, :])
    R = nearest_rotation(H)
    return R, x - (R @ q[..., None])[..., 0]


@compiled
def moments(V: Floats, x: Floats, weight: Floats, label: Ints, count: int) -> Floats:
    """Sums over the vertices of every label, in every frame.

    V       : (vertex, xyz) reference, mesh unit; near the origin, or digits are lost
    x       : (frame, vertex, xyz) mesh unit
    weight  : (frame, vertex) not negative
    label   : (vertex,) the set of each, −1 for none
    count   : sets
    returns : (set, frame, 17) see `MOMENTS`
    """
    M = np.zeros((count, x.shape[0], MOMENTS))
    for t in range(x.shape[0]):
        for v in range(len(label)):
            if label[v] >= 0:
                added(M[label[v], t], V, x, t, v, weight[t, v])
    return M


@compiled
def added(m: Floats, V: Floats, x: Floats, t: int, v: int, w: float) -> None:
    """Adds vertex v in frame t to the sums m (17,) with weight w; V and x as in `moments`."""
    m[0] += w
    for i in range(3):
        q, y = w * V[v, i], w * x[t, v, i]
        m[7] += q * V[v, i] + y * x[t, v, i]
        m[1 + i] += q
        m[4 + i] += y
        for j in range(3):
            m[8 + 3 * i + j] += q * x[t, v, j]


@compiled
def residual(m: Floats) -> float:
    """Least Σ w |R q + t − x|² over R and t: Σ w (|q|² + |x|²) about both means − 2 `rotation_gain`  (Theobald 2005).

    m       : (17,) of one set in one frame; see `MOMENTS`
    returns : mesh unit² times weight; 0 for an empty set
    """
    if m[0] <= 0.0:
        return 0.0
    H = np.empty((3, 3))
    inner = _centred(m, H)
    if inner <= 0.0:
        return 0.0
    return max(inner - 2.0 * largest_root(H, 0.5 * inner), 0.0)


@compiled
def motion(m: Floats, R: Floats, t: Floats) -> None:
    """Writes the rigid motion of least residual: x ≈ R q + t; the identity for an empty set  (Horn 1987, Sec. 4A).

    m : (17,) of one set in one frame; see `MOMENTS`
    R : (3, 3), written
    t : (xyz,) mesh unit, written
    """
    for i in range(3):
        t[i] = 0.0
        for j in range(3):
            R[i, j] = 1.0 if i == j else 0.0
    if m[0] <= 0.0:
        return
    H = np.empty((3, 3))
    if _centred(m, H) > 0.0:
        write_rotation(jacobi_eigenvector(quaternion_matrix(H)), R)
    for i in range(3):
        t[i] = m[4 + i] / m[0]
        for j in range(3):
            t[i] -= R[i, j] * m[1 + j] / m[0]


@compiled
def rotation_gain(H: Floats) -> float:
    """Largest tr(Rᵀ H) over rotations R: the sum of H's singular values with the sign of det H on the smallest.

    H : (3, 3) Σ w x qᵀ, any unit
    """
    square = 0.0
    for i in range(3):
        for j in range(3):
            square += H[i, j] * H[i, j]
    return largest_root(H, np.sqrt(3.0 * square)) if square > 0.0 else 0.0


@compiled
def turn_all(H: Floats, R: Floats) -> Floats:
    """`turn_towards` for many matrices.

    H, R    : (matrix, 3, 3), R changed in place
    returns : (matrix,) tr(Rᵀ H) after it
    """
    out = np.empty(len(H))
    for i in range(len(H)):
        out[i] = turn_towards(H[i], R[i])
    return out


@compiled
def turn_towards(H: Floats, R: Floats) -> float:
    """Turns R to the rotation with the largest tr(Rᵀ H), reflections left out; returns that trace.

    R stays where rounding would make the trace smaller, so that an energy −tr never rises (for ARAP: Sorkine, Alexa 2007,
    Eq. 6), and where every rotation about an axis does equally well, as for a matrix of rank 1.

    H : (3, 3) Σ w x qᵀ, where rotating q should give x; any unit
    R : (3, 3) changed in place; a rotation to begin with
    """
    size = square = 0.0
    for i in range(3):
        for k in range(3):
            size += R[i, k] * H[i, k]
            square += H[i, k] * H[i, k]
    if not square > 0.0:
        return size
    before, q = size / np.sqrt(square), np.empty(4)
    G = H / np.sqrt(square)
    N = quaternion_matrix(G)
    top = largest_root(G, np.sqrt(3.0))
    for _ in range(2):
        if not adjugate_eigenvector(N, top, q):
            return size
        # the quotient of a vector that errs by e errs by e²
        top = 0.0
        for i in range(4):
            for k in range(4):
                top += q[i] * N[i, k] * q[k]
    if top <= before:
        return size
    write_rotation(q, R)
    return top * np.sqrt(square)


@compiled
def _centred(m: Floats, H: Floats) -> float:
    """Writes H = Σ w (x − x̄)(q − q̄)ᵀ; returns Σ w (|q − q̄|² + |x − x̄|²)."""
    inner = m[7]
    for i in range(3):
        inner -= (m[1 + i] * m[1 + i] + m[4 + i] * m[4 + i]) / m[0]
        for j in range(3):
            H[j, i] = m[8 + 3 * i + j] - m[1 + i] * m[4 + j] / m[0]
    return inner
