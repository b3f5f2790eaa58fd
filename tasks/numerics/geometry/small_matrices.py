"""Small matrices within compiled loops, where a call of an array function takes longer than its work."""

import numpy as np

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.compiled import compiled


@compiled
def solved(H: Floats, g: Floats, free: int) -> Floats:
    """(unknown,) the solution of the first `free` of positive definite equations (Cholesky), 0 for the others.

    H : (unknown, unknown) the diagonal and above are read; overwritten
    """
    z = np.zeros(len(g))
    for p in range(free):
        for q in range(p, free):
            for k in range(p):
                H[p, q] -= H[k, p] * H[k, q]
        root = np.sqrt(H[p, p])
        z[p] = g[p]
        for k in range(p):
            z[p] -= H[k, p] * z[k]
        z[p] /= root
        for q in range(p, free):
            H[p, q] /= root
    for p in range(free - 1, -1, -1):
        for k in range(p + 1, free):
            z[p] -= H[p, k] * z[k]
        z[p] /= H[p, p]
    return z


@compiled
def rotation(w: Floats, longest: float) -> Floats:
    """(3, 3) the rotation by a vector w (xyz,), radian, at most by `longest` (Rodrigues)."""
    length = np.sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2])
    angle = max(min(length, longest), 1e-12)
    share = min(1.0, longest / max(length, 1e-12)) / angle
    sine, versine, out = np.sin(angle), 1.0 - np.cos(angle), np.empty((3, 3))
    for x in range(3):
        a, b = (x + 1) % 3, (x + 2) % 3
        i, j, k = share * w[x], share * w[a], share * w[b]
        out[x, x] = 1.0 - versine * (j * j + k * k)
        out[x, a] = versine * i * j - sine * k
        out[x, b] = versine * i * k + sine * j
    return out


@compiled
def product(A: Floats, B: Floats) -> Floats:
    """(3, 3) A B."""
    out = np.empty((3, 3))
    for x in range(3):
        for y in range(3):
            out[x, y] = A[x, 0] * B[0, y] + A[x, 1] * B[1, y] + A[x, 2] * B[2, y]
    return out
