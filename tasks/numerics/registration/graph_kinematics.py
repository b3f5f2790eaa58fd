"""Where points go when the nodes of a deformation graph turn and shift (Sumner 2007, Eq. 1)."""

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.compiled import compiled


@compiled
def deformed(rest: Floats, bound: Ints, weight: Floats, g: Floats, R: Floats, p: Floats) -> Floats:
    """x(v) = Σ_j w_vj [R_j (v − g_j) + p_j].

    rest    : (point, xyz) mesh unit
    bound   : (point, 4) nodes each point follows
    weight  : (point, 4) each row sums to 1
    g       : (node, xyz) nodes at rest, mesh unit
    R, p    : (node, 3, 3) · (node, xyz) mesh unit
    returns : (point, xyz) mesh unit
    """
    out = np.zeros_like(rest)
    for v in range(len(rest)):
        for k in range(bound.shape[1]):
            j, w = bound[v, k], weight[v, k]
            d0, d1, d2 = rest[v, 0] - g[j, 0], rest[v, 1] - g[j, 1], rest[v, 2] - g[j, 2]
            for x in range(3):
                out[v, x] += w * (R[j, x, 0] * d0 + R[j, x, 1] * d1 + R[j, x, 2] * d2 + p[j, x])
    return out


@compiled
def turned(N: Floats, bound: Ints, weight: Floats, R: Floats) -> Floats:
    """Normals turned with the nodes, n(v) = Σ_j w_vj R_j n, made unit again.

    N       : (point, xyz) unit
    returns : (point, xyz) unit; 0 where N is
    """
    out = np.zeros_like(N)
    for v in range(len(N)):
        for k in range(bound.shape[1]):
            j, w = bound[v, k], weight[v, k]
            for x in range(3):
                out[v, x] += w * (R[j, x, 0] * N[v, 0] + R[j, x, 1] * N[v, 1] + R[j, x, 2] * N[v, 2])
        length = np.sqrt(out[v, 0] ** 2 + out[v, 1] ** 2 + out[v, 2] ** 2)
        if length > 0.0:
            for x in range(3):
                out[v, x] /= length
    return out


@compiled
def stepped(R: Floats, p: Floats, step: Floats, share: float) -> tuple[Floats, Floats]:
    """Every node turned by exp(share · ω) and shifted by share · δ  (Rodrigues).

    R, p    : (node, 3, 3) · (node, xyz) mesh unit
    step    : (node, 6) ω in radians about the axes of space, then δ in the mesh's unit
    returns : (node, 3, 3) · (node, xyz)
    """
    R_new, p_new = np.empty_like(R), p + share * step[:, 3:]
    for j in range(len(R)):
        w0, w1, w2 = share * step[j, 0], share * step[j, 1], share * step[j, 2]
        square = w0 * w0 + w1 * w1 + w2 * w2
        angle = np.sqrt(square)
        s = np.sin(angle) / angle if angle > 1e-8 else 1.0
        c = (1.0 - np.cos(angle)) / square if angle > 1e-8 else 0.5
        for y in range(3):
            a0, a1, a2 = R[j, 0, y], R[j, 1, y], R[j, 2, y]
            b0, b1, b2 = w1 * a2 - w2 * a1, w2 * a0 - w0 * a2, w0 * a1 - w1 * a0
            R_new[j, 0, y] = a0 + s * b0 + c * (w1 * b2 - w2 * b1)
            R_new[j, 1, y] = a1 + s * b1 + c * (w2 * b0 - w0 * b2)
            R_new[j, 2, y] = a2 + s * b2 + c * (w0 * b1 - w1 * b0)
    return R_new, p_new
