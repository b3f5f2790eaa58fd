"""Energy of the edges of a deformation graph: every edge should have the same shape seen from both its ends.

|R_j (g_k − g_j) + p_j − p_k|² is how far node k is from where node j would carry it (Sumner 2007, Eq. 7; as rigid as
possible, Sorkine and Alexa 2007, on the graph).
"""

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.inlined import inlined


@compiled
def add_edges(
    D: Floats, B: Floats, b: Floats, edge: Ints, of_edge: Ints, stiffness: Floats, R: Floats, p: Floats, g: Floats
) -> None:
    """Add s |R_j (g_k − g_j) + p_j − p_k|² for both ends j of every edge.

    D, B, b   : (node, 6, 6), (block, 6, 6), (node, 6) changed in place
    edge      : (edge, 2) · of_edge : (edge,) the block of each · stiffness : (edge,) λ s
    R, p, g   : (node, 3, 3) · (node, xyz) · (node, xyz) at rest
    """
    q, r, T = np.empty(3), np.empty(3), np.zeros((3, 3))
    for e in range(len(edge)):
        s, n = stiffness[e], of_edge[e]
        for end in range(2):
            j, k = edge[e, end], edge[e, 1 - end]
            _edge(j, k, R, p, g, q, r)
            T[0, 1], T[0, 2], T[1, 2] = -s * q[2], s * q[1], -s * q[0]
            T[1, 0], T[2, 0], T[2, 1] = s * q[2], -s * q[1], s * q[0]
            square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2]
            for x in range(3):
                y, z = (x + 1) % 3, (x + 2) % 3
                b[j, x] -= s * (q[y] * r[z] - q[z] * r[y])
                b[j, 3 + x] -= s * r[x]
                b[k, 3 + x] += s * r[x]
                D[j, x, x] += s * square
                D[j, 3 + x, 3 + x] += s
                D[k, 3 + x, 3 + x] += s
                B[n, 3 + x, 3 + x] -= s
                for y in range(3):
                    D[j, x, y] -= s * q[x] * q[y]
                    D[j, x, 3 + y] += T[x, y]
                    D[j, 3 + x, y] += T[y, x]
                    if end == 0:
                        B[n, x, 3 + y] -= T[x, y]
                    else:
                        B[n, 3 + x, y] -= T[y, x]


@compiled
def edge_energy(edge: Ints, stiffness: Floats, R: Floats, p: Floats, g: Floats) -> float:
    """Σ s |R_j (g_k − g_j) + p_j − p_k|² over both ends of every edge, mesh unit²."""
    total = 0.0
    q, r = np.empty(3), np.empty(3)
    for e in range(len(edge)):
        for end in range(2):
            _edge(edge[e, end], edge[e, 1 - end], R, p, g, q, r)
            total += stiffness[e] * (r[0] * r[0] + r[1] * r[1] + r[2] * r[2])
    return total


@compiled
def strains(edge: Ints, R: Floats, p: Floats, g: Floats) -> Floats:
    """How far each edge is from being rigid, the mean over its ends of |R_j (g_k − g_j) + p_j − p_k|² / |g_k − g_j|².

    edge    : (edge, 2)
    R, p, g : (node, 3, 3) · (node, xyz) · (node, xyz) at rest
    returns : (edge,) without unit; 0 for an edge without length
    """
    out = np.zeros(len(edge))
    q, r = np.empty(3), np.empty(3)
    for e in range(len(edge)):
        length = 0.0
        for end in range(2):
            _edge(edge[e, end], edge[e, 1 - end], R, p, g, q, r)
            out[e] += 0.5 * (r[0] * r[0] + r[1] * r[1] + r[2] * r[2])
            length = q[0] * q[0] + q[1] * q[1] + q[2] * q[2]
        out[e] = out[e] / length if length > 0.0 else 0.0
    return out


@inlined
def _edge(j: int, k: int, R: Floats, p: Floats, g: Floats, q: Floats, r: Floats) -> None:
    """Writes into q the edge turned with j, into r the vector from node k to where node j would carry it."""
    d0, d1, d2 = g[k, 0] - g[j, 0], g[k, 1] - g[j, 1], g[k, 2] - g[j, 2]
    for x in range(3):
        q[x] = R[j, x, 0] * d0 + R[j, x, 1] * d1 + R[j, x, 2] * d2
        r[x] = q[x] + p[j, x] - p[k, x]
