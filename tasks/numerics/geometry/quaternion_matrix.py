"""The quaternion matrix of a 3 × 3 matrix H, whose first eigenvector is the rotation R of largest tr(Rᵀ H) (Horn 1987, 4A)."""

import numpy as np

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.compiled import compiled

_NEWTON_STEPS = 60
"""Safety bound; 5 to 10 are usual, more only where two eigenvalues meet."""
_NEWTON_STEP = 1e-14
"""Step at which the root counts as reached, share of the bound it is sought below."""
_JACOBI_SWEEPS = 30
"""Safety bound; 4 to 6 are usual."""
_JACOBI_OFF = 1e-26
"""Squared size of what stands beside the diagonal when it counts as nought, share of the diagonal's."""


@compiled
def quaternion_matrix(H: Floats) -> Floats:
    """The symmetric 4 × 4 matrix N with qᵀ N q = tr(Rᵀ H) for the rotation R of a unit quaternion q.

    H       : (3, 3) any unit
    returns : (4, 4) the same unit
    """
    N = np.empty((4, 4))
    N[0, 0] = H[0, 0] + H[1, 1] + H[2, 2]
    N[1, 1] = H[0, 0] - H[1, 1] - H[2, 2]
    N[2, 2] = H[1, 1] - H[0, 0] - H[2, 2]
    N[3, 3] = H[2, 2] - H[0, 0] - H[1, 1]
    N[0, 1] = N[1, 0] = H[2, 1] - H[1, 2]
    N[0, 2] = N[2, 0] = H[0, 2] - H[2, 0]
    N[0, 3] = N[3, 0] = H[1, 0] - H[0, 1]
    N[1, 2] = N[2, 1] = H[0, 1] + H[1, 0]
    N[1, 3] = N[3, 1] = H[0, 2] + H[2, 0]
    N[2, 3] = N[3, 2] = H[1, 2] + H[2, 1]
    return N


@compiled
def largest_root(H: Floats, bound: float) -> float:
    """Largest eigenvalue of H's quaternion matrix, a root of (x² − |H|²)² = 4 Σ minors² + 8 x det H, by Newton's steps.

    H       : (3, 3) any unit
    bound   : not below the eigenvalue, above 0, the same unit; the steps begin there
    returns : the same unit
    """
    s = 1.0 / bound
    a, b, c = H[0, 0] * s, H[1, 0] * s, H[2, 0] * s
    d, e, f = H[0, 1] * s, H[1, 1] * s, H[2, 1] * s
    g, h, i = H[0, 2] * s, H[1, 2] * s, H[2, 2] * s
    det = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
    norm = a * a + b * b + c * c + d * d + e * e + f * f + g * g + h * h + i * i
    p, q, r = a * a + d * d + g * g, b * b + e * e + h * h, c * c + f * f + i * i
    pq, pr, qr = a * b + d * e + g * h, a * c + d * f + g * i, b * c + e * f + h * i
    minors = p * q - pq * pq + p * r - pr * pr + q * r - qr * qr
    c2, c1, c0 = -2.0 * norm, -8.0 * det, norm * norm - 4.0 * minors
    x = 1.0
    for _ in range(_NEWTON_STEPS):
        slope = (4.0 * x * x + 2.0 * c2) * x + c1
        if slope <= 0.0:
            break
        step = (((x * x + c2) * x + c1) * x + c0) / slope
        x -= step
        if step < _NEWTON_STEP:
            break
    return max(x, 0.0) * bound


@compiled
def adjugate_eigenvector(N: Floats, value: float, q: Floats) -> bool:
    """Writes the eigenvector of one eigenvalue: the unit vector along the longest column of the adjugate of N − value.

    N       : (4, 4) symmetric
    value   : the eigenvalue, in N's unit
    q       : (4,) written
    returns : False where the adjugate is nought, as where eigenvalues meet
    """
    A, column = N.copy(), np.empty(4)
    for k in range(4):
        A[k, k] -= value
    best = 0.0
    for k in range(4):
        square = 0.0
        for i in range(4):
            column[i] = _cofactor(A, i, k)
            square += column[i] * column[i]
        if square > best:
            best = square
            for i in range(4):
                q[i] = column[i] / np.sqrt(square)
    return best > 0.0


@compiled
def jacobi_eigenvector(N: Floats) -> Floats:
    """Unit eigenvector of the largest eigenvalue by Jacobi's rotations; one of several where eigenvalues meet.

    N       : (4, 4) symmetric, changed
    returns : (4,)
    """
    Q = np.eye(4)
    for _ in range(_JACOBI_SWEEPS):
        off = N[0, 1] ** 2 + N[0, 2] ** 2 + N[0, 3] ** 2 + N[1, 2] ** 2 + N[1, 3] ** 2 + N[2, 3] ** 2
        if off <= _JACOBI_OFF * (N[0, 0] ** 2 + N[1, 1] ** 2 + N[2, 2] ** 2 + N[3, 3] ** 2 + off):
            break
        for i in range(3):
            for j in range(i + 1, 4):
                _annihilate(N, Q, i, j)
    k = 0
    for i in range(1, 4):
        if N[i, i] > N[k, k]:
            k = i
    return Q[:, k].copy()


@compiled
def write_rotation(q: Floats, R: Floats) -> None:
    """Writes the rotation of a unit quaternion.

    q : (4,) real part first
    R : (3, 3) written
    """
    w, x, y, z = q[0], q[1], q[2], q[3]
    R[0, 0], R[0, 1], R[0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)
    R[1, 0], R[1, 1], R[1, 2] = 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
    R[2, 0], R[2, 1], R[2, 2] = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)


@compiled
def _cofactor(A: Floats, i: int, k: int) -> float:
    """One cofactor of a 4 × 4 matrix."""
    a, b, c = (i + 1) & 3, (i + 2) & 3, (i + 3) & 3
    x, y, z = (k + 1) & 3, (k + 2) & 3, (k + 3) & 3
    minor = A[a, x] * (A[b, y] * A[c, z] - A[b, z] * A[c, y])
    minor -= A[a, y] * (A[b, x] * A[c, z] - A[b, z] * A[c, x])
    minor += A[a, z] * (A[b, x] * A[c, y] - A[b, y] * A[c, x])
    return -minor if (i + k) & 1 else minor


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
