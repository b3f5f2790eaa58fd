"""How far a set of points is from moving as one rigid body, from sums alone (after Horn 1987; Theobald 2005).

The sums of two disjoint sets add up to those of their union, so that the residual of any run of rings, or of any two
patches together, costs the same however many vertices they have.
"""

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.compiled import compiled

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

MOMENTS = 17
"""Numbers a set and frame: mass, Σ q, Σ x, Σ (|q|² + |x|²), Σ q xᵀ by rows."""


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
    """Adds vertex v in frame t to the sums m (17,) with weight w."""
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
    """Least Σ w |R q + t − x|² over R and t: A + B − 2 λ, λ the largest eigenvalue of the 4 × 4 quaternion matrix.

    m       : (17,) of one set in one frame; see `MOMENTS`
    returns : mesh unit² times weight; 0 for an empty set
    """
    if m[0] <= 0.0:
        return 0.0
    C = np.empty(9)
    inner = _centred(m, C)
    if inner <= 0.0:
        return 0.0
    return max(inner - 2.0 * _largest(C, 0.5 * inner), 0.0)


@compiled
def motion(m: Floats, R: Floats, t: Floats) -> None:
    """Writes the rigid motion of least residual: x ≈ R q + t; the identity for an empty set.

    m : (17,) of one set in one frame; R : (3, 3) and t : (xyz), written
    """
    for i in range(3):
        t[i] = 0.0
        for j in range(3):
            R[i, j] = 1.0 if i == j else 0.0
    if m[0] <= 0.0:
        return
    C = np.empty(9)
    inner = _centred(m, C)
    if inner > 0.0:
        _rotation(C, R)
    for i in range(3):
        t[i] = m[4 + i] / m[0]
        for j in range(3):
            t[i] -= R[i, j] * m[1 + j] / m[0]


@compiled
def _centred(m: Floats, C: Floats) -> float:
    """Writes the cross-covariance Σ w (q − q̄)(x − x̄)ᵀ by rows; returns Σ w (|q − q̄|² + |x − x̄|²)."""
    inner = m[7]
    for i in range(3):
        inner -= (m[1 + i] * m[1 + i] + m[4 + i] * m[4 + i]) / m[0]
        for j in range(3):
            C[3 * i + j] = m[8 + 3 * i + j] - m[1 + i] * m[4 + j] / m[0]
    return inner


@compiled
def _largest(C: Floats, bound: float) -> float:
    """Largest root of the quaternion matrix's characteristic polynomial λ⁴ + c₂ λ² + c₁ λ + c₀, by Newton from above."""
    s = 1.0 / bound
    a, b, c, d, e, f, g, h, i = C[0] * s, C[1] * s, C[2] * s, C[3] * s, C[4] * s, C[5] * s, C[6] * s, C[7] * s, C[8] * s
    det = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
    norm = a * a + b * b + c * c + d * d + e * e + f * f + g * g + h * h + i * i
    p, q, r = a * a + d * d + g * g, b * b + e * e + h * h, c * c + f * f + i * i
    pq, pr, qr = a * b + d * e + g * h, a * c + d * f + g * i, b * c + e * f + h * i
    minors = p * q - pq * pq + p * r - pr * pr + q * r - qr * qr
    c2, c1, c0 = -2.0 * norm, -8.0 * det, norm * norm - 4.0 * minors
    x = 1.0
    for _ in range(60):
        slope = (4.0 * x * x + 2.0 * c2) * x + c1
        if slope <= 0.0:
            break
        step = (((x * x + c2) * x + c1) * x + c0) / slope
        x -= step
        if step < 1e-14:
            break
    return max(x, 0.0) * bound


@compiled
def _rotation(C: Floats, R: Floats) -> None:
    """Writes the rotation of the quaternion matrix's first eigenvector, by Jacobi's rotations."""
    N = np.empty((4, 4))
    N[0, 0] = C[0] + C[4] + C[8]
    N[1, 1], N[2, 2], N[3, 3] = C[0] - C[4] - C[8], C[4] - C[0] - C[8], C[8] - C[0] - C[4]
    N[0, 1], N[0, 2], N[0, 3] = C[5] - C[7], C[6] - C[2], C[1] - C[3]
    N[1, 2], N[1, 3], N[2, 3] = C[1] + C[3], C[2] + C[6], C[5] + C[7]
    Q = np.eye(4)
    for _ in range(30):
        off = N[0, 1] ** 2 + N[0, 2] ** 2 + N[0, 3] ** 2 + N[1, 2] ** 2 + N[1, 3] ** 2 + N[2, 3] ** 2
        if off <= 1e-26 * (N[0, 0] ** 2 + N[1, 1] ** 2 + N[2, 2] ** 2 + N[3, 3] ** 2 + off):
            break
        for i in range(3):
            for j in range(i + 1, 4):
                _annihilate(N, Q, i, j)
    k = 0
    for i in range(1, 4):
        if N[i, i] > N[k, k]:
            k = i
    w, x, y, z = Q[0, k], Q[1, k], Q[2, k], Q[3, k]
    R[0, 0], R[0, 1], R[0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)
    R[1, 0], R[1, 1], R[1, 2] = 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
    R[2, 0], R[2, 1], R[2, 2] = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)


@compiled
def _annihilate(N: Floats, Q: Floats, i: int, j: int) -> None:
    """One rotation of Jacobi's on the upper triangle of N, kept in Q."""
    if N[i, j] == 0.0:
        return
    tau = (N[j, j] - N[i, i]) / (2.0 * N[i, j])
    t = (1.0 if tau >= 0.0 else -1.0) / (abs(tau) + np.sqrt(1.0 + tau * tau))
    c = 1.0 / np.sqrt(1.0 + t * t)
    s = t * c
    for k in range(4):
        Q[k, i], Q[k, j] = c * Q[k, i] - s * Q[k, j], s * Q[k, i] + c * Q[k, j]
        if k != i and k != j:
            p, q, m, n = min(k, i), max(k, i), min(k, j), max(k, j)
            N[p, q], N[m, n] = c * N[p, q] - s * N[m, n], s * N[p, q] + c * N[m, n]
    N[i, i] -= t * N[i, j]
    N[j, j] += t * N[i, j]
    N[i, j] = 0.0
