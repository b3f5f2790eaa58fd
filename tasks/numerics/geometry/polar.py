"""The rotation nearest to a 3 × 3 matrix, without a singular value decomposition (for ARAP: Sorkine, Alexa 2007, Eq. 6)."""

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.compiled import compiled

Floats = npt.NDArray[np.float64]

_STEPS = 60  # Newton's from above: 5 to 10 are usual, more only where two eigenvalues meet
_EXACT = 1e-15


@compiled
def turn_all(H: Floats, R: Floats) -> Floats:
    """`turn_towards` for many matrices.

    H, R    : (vertex, row, xyz), R changed in place
    returns : (vertex,) tr(Rᵀ H) after it
    """
    out = np.empty(len(H))
    for i in range(len(H)):
        out[i] = turn_towards(H[i], R[i])
    return out


@compiled
def turn_towards(H: Floats, R: Floats) -> float:
    """Turn R to the rotation with the largest tr(Rᵀ H), reflections left out; the largest trace is returned.

    The unit quaternion of that rotation belongs to the largest eigenvalue of a symmetric 4 × 4 matrix (Horn 1987, Sec. 4A),
    which is the largest root of its quartic. R stays where rounding would make the trace smaller, so that an energy −tr never
    rises, and where every rotation about an axis does equally well, as for a matrix of rank 1.

    H : (row, xyz) Σ w x pᵀ, where rotating p should give x; any unit
    R : (row, xyz) changed in place; a rotation to begin with
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
    N = _horn(G)
    top = _largest_root(N, G)
    for _ in range(2):
        if not _eigenvector(N, top, q):
            return size
        # the quotient of a vector that errs by e errs by e²
        top = 0.0
        for i in range(4):
            for k in range(4):
                top += q[i] * N[i, k] * q[k]
    if top <= before:
        return size
    _rotation(q, R)
    return top * np.sqrt(square)


@compiled
def _horn(H: Floats) -> Floats:
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
def _largest_root(N: Floats, H: Floats) -> float:
    """Largest eigenvalue for |H| = 1, by Newton from above on x⁴ − 2x² − 8 det(H) x + det(N)."""
    b = -8.0 * (
        H[0, 0] * (H[1, 1] * H[2, 2] - H[1, 2] * H[2, 1])
        - H[0, 1] * (H[1, 0] * H[2, 2] - H[1, 2] * H[2, 0])
        + H[0, 2] * (H[1, 0] * H[2, 1] - H[1, 1] * H[2, 0])
    )
    c = 0.0
    for k in range(4):
        c += N[0, k] * _cofactor(N, 0, k)
    x = np.sqrt(3.0)
    for _ in range(_STEPS):
        slope = 4.0 * x * (x * x - 1.0) + b
        if not slope > 0.0:
            break
        step = ((x * x - 2.0) * x * x + b * x + c) / slope
        x -= step
        if step < _EXACT:
            break
    return x


@compiled
def _eigenvector(N: Floats, value: float, q: Floats) -> bool:
    """Unit vector along the longest column of the adjugate of N − value; False where it has none."""
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
def _cofactor(A: Floats, i: int, k: int) -> float:
    a, b, c = (i + 1) & 3, (i + 2) & 3, (i + 3) & 3
    x, y, z = (k + 1) & 3, (k + 2) & 3, (k + 3) & 3
    minor = A[a, x] * (A[b, y] * A[c, z] - A[b, z] * A[c, y])
    minor -= A[a, y] * (A[b, x] * A[c, z] - A[b, z] * A[c, x])
    minor += A[a, z] * (A[b, x] * A[c, y] - A[b, y] * A[c, x])
    return -minor if (i + k) & 1 else minor


@compiled
def _rotation(q: Floats, R: Floats) -> None:
    w, x, y, z = q[0], q[1], q[2], q[3]
    R[0, 0], R[1, 1], R[2, 2] = w * w + x * x - y * y - z * z, w * w - x * x + y * y - z * z, w * w - x * x - y * y + z * z
    R[0, 1], R[1, 0] = 2.0 * (x * y - w * z), 2.0 * (x * y + w * z)
    R[0, 2], R[2, 0] = 2.0 * (x * z + w * y), 2.0 * (x * z - w * y)
    R[1, 2], R[2, 1] = 2.0 * (y * z - w * x), 2.0 * (y * z + w * x)
