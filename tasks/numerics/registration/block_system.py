"""A symmetric system of 6 × 6 blocks, one unknown turn and shift per node: assembled pair by pair, solved by PCG.

Every row of data touches at most four nodes, so its part of JᵀJ is ten blocks that are added directly; no sparse
Jacobian is ever formed. All sums run in a fixed order on one thread.
"""

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.geometry.neighbours import distinct
from kinetree.tasks.numerics.inlined import inlined


def pattern(bound: Ints, edge: Ints, nodes: int) -> tuple[Ints, Ints, Ints]:
    """Which off-diagonal blocks there are: pairs of nodes that share a vertex or an edge.

    bound   : (vertex, 4) ascending along each row
    edge    : (edge, 2) the smaller first
    nodes   : how many
    returns : (block, 2) pairs, the smaller first, sorted · (vertex, 6) the block of each pair of its nodes in the order
              01 02 03 12 13 23, −1 where both are one node · (edge,) the block of each edge
    """
    first, second = np.triu_indices(bound.shape[1], 1)
    code = bound[:, first] * nodes + bound[:, second]
    different = bound[:, first] != bound[:, second]
    edge_code = edge[:, 0] * nodes + edge[:, 1]
    every = distinct(np.concatenate([code[different], edge_code]))
    of_vertex = np.where(different, np.searchsorted(every, code), -1)
    return np.stack([every // nodes, every % nodes], axis=1), of_vertex, np.searchsorted(every, edge_code)


@compiled
def add_data(
    D: Floats, B: Floats, b: Floats, rest: Floats, bound: Ints, weight: Floats, of_vertex: Ints,
    R: Floats, g: Floats, vertex: Ints, residual: Floats, normal: Floats, plane: Floats, point: Floats,
) -> None:  # fmt: skip
    """Add rows plane·(n·r)² + point·|r|² with r = x(v) − y to the blocks.

    D, B, b  : (node, 6, 6), (block, 6, 6), (node, 6) changed in place; b is −Jᵀ r
    rest     : (vertex, xyz)
    R, g     : (node, 3, 3) · (node, xyz)
    vertex   : (row,) the model's vertex of each row
    residual : (row, xyz) · normal : (row, xyz) · plane, point : (row,) weights
    """
    A, q, M, f = np.empty((4, 3, 3)), np.empty((4, 3)), np.empty((3, 3)), np.empty(3)
    for i in range(len(vertex)):
        along = 0.0
        for x in range(3):
            along += normal[i, x] * residual[i, x]
        for x in range(3):
            f[x] = plane[i] * along * normal[i, x] + point[i] * residual[i, x]
            for y in range(3):
                M[x, y] = plane[i] * normal[i, x] * normal[i, y]
            M[x, x] += point[i]
        _add_row(D, B, b, rest, bound, weight, of_vertex, R, g, vertex[i], f, M, A, q)


@compiled
def add_forms(
    D: Floats, B: Floats, b: Floats, rest: Floats, bound: Ints, weight: Floats, of_vertex: Ints,
    R: Floats, g: Floats, vertex: Ints, form: Floats, slope: Floats,
) -> None:  # fmt: skip
    """Add rows with any quadratic form of r = x(v) − y to the blocks; see `add_data` for the other arguments.

    form  : (row, 3, 3) half of the second derivative by x(v), symmetric
    slope : (row, xyz) half of the first
    """
    A, q = np.empty((4, 3, 3)), np.empty((4, 3))
    for i in range(len(vertex)):
        _add_row(D, B, b, rest, bound, weight, of_vertex, R, g, vertex[i], slope[i], form[i], A, q)


@inlined
def _add_row(
    D: Floats, B: Floats, b: Floats, rest: Floats, bound: Ints, weight: Floats, of_vertex: Ints,
    R: Floats, g: Floats, v: int, f: Floats, M: Floats, A: Floats, q: Floats,
) -> None:  # fmt: skip
    """One row with form M (3, 3) and slope f (xyz); A (4, 3, 3) and q (4, 3) are room to work in."""
    f0, f1, f2 = f[0], f[1], f[2]
    m00, m01, m02, m10, m11, m12 = M[0, 0], M[0, 1], M[0, 2], M[1, 0], M[1, 1], M[1, 2]
    m20, m21, m22 = M[2, 0], M[2, 1], M[2, 2]
    for k in range(4):
        j, w = bound[v, k], weight[v, k]
        d0, d1, d2 = rest[v, 0] - g[j, 0], rest[v, 1] - g[j, 1], rest[v, 2] - g[j, 2]
        q0 = R[j, 0, 0] * d0 + R[j, 0, 1] * d1 + R[j, 0, 2] * d2
        q1 = R[j, 1, 0] * d0 + R[j, 1, 1] * d1 + R[j, 1, 2] * d2
        q2 = R[j, 2, 0] * d0 + R[j, 2, 1] * d1 + R[j, 2, 2] * d2
        q[k, 0], q[k, 1], q[k, 2] = q0, q1, q2
        A[k, 0, 0], A[k, 0, 1], A[k, 0, 2] = q1 * m20 - q2 * m10, q1 * m21 - q2 * m11, q1 * m22 - q2 * m12
        A[k, 1, 0], A[k, 1, 1], A[k, 1, 2] = q2 * m00 - q0 * m20, q2 * m01 - q0 * m21, q2 * m02 - q0 * m22
        A[k, 2, 0], A[k, 2, 1], A[k, 2, 2] = q0 * m10 - q1 * m00, q0 * m11 - q1 * m01, q0 * m12 - q1 * m02
        b[j, 0] -= w * (q1 * f2 - q2 * f1)
        b[j, 1] -= w * (q2 * f0 - q0 * f2)
        b[j, 2] -= w * (q0 * f1 - q1 * f0)
        b[j, 3] -= w * f0
        b[j, 4] -= w * f1
        b[j, 5] -= w * f2
    pair = 0
    for k in range(4):
        j = bound[v, k]
        _add(D, j, A, q, k, k, m00, m01, m02, m10, m11, m12, m20, m21, m22, weight[v, k] * weight[v, k])
        for m in range(k + 1, 4):
            w = weight[v, k] * weight[v, m]
            block = of_vertex[v, pair]
            pair += 1
            if w == 0.0:
                continue
            if block >= 0:
                _add(B, block, A, q, k, m, m00, m01, m02, m10, m11, m12, m20, m21, m22, w)
            else:
                _add(D, j, A, q, k, m, m00, m01, m02, m10, m11, m12, m20, m21, m22, w)
                _add(D, j, A, q, m, k, m00, m01, m02, m10, m11, m12, m20, m21, m22, w)


@inlined
def _add(
    to: Floats, n: int, A: Floats, q: Floats, j: int, k: int,
    m00: float, m01: float, m02: float, m10: float, m11: float, m12: float, m20: float, m21: float, m22: float, w: float,
) -> None:  # fmt: skip
    """Add w · J_jᵀ M J_k to block n, with J = [−[q]×, 1]: its turn-turn part is A_j [q_k]×ᵀ, whose rows are q_k × row.

    Written out, and everything read before anything is written: the compiler cannot know that the arrays do not overlap.
    """
    a00, a01, a02, a10, a11, a12 = A[j, 0, 0], A[j, 0, 1], A[j, 0, 2], A[j, 1, 0], A[j, 1, 1], A[j, 1, 2]
    a20, a21, a22, q0, q1, q2 = A[j, 2, 0], A[j, 2, 1], A[j, 2, 2], q[k, 0], q[k, 1], q[k, 2]
    c00, c01, c02, c10, c11, c12 = A[k, 0, 0], A[k, 1, 0], A[k, 2, 0], A[k, 0, 1], A[k, 1, 1], A[k, 2, 1]
    c20, c21, c22 = A[k, 0, 2], A[k, 1, 2], A[k, 2, 2]
    to[n, 0, 0] += w * (q1 * a02 - q2 * a01)
    to[n, 0, 1] += w * (q2 * a00 - q0 * a02)
    to[n, 0, 2] += w * (q0 * a01 - q1 * a00)
    to[n, 0, 3] += w * a00
    to[n, 0, 4] += w * a01
    to[n, 0, 5] += w * a02
    to[n, 1, 0] += w * (q1 * a12 - q2 * a11)
    to[n, 1, 1] += w * (q2 * a10 - q0 * a12)
    to[n, 1, 2] += w * (q0 * a11 - q1 * a10)
    to[n, 1, 3] += w * a10
    to[n, 1, 4] += w * a11
    to[n, 1, 5] += w * a12
    to[n, 2, 0] += w * (q1 * a22 - q2 * a21)
    to[n, 2, 1] += w * (q2 * a20 - q0 * a22)
    to[n, 2, 2] += w * (q0 * a21 - q1 * a20)
    to[n, 2, 3] += w * a20
    to[n, 2, 4] += w * a21
    to[n, 2, 5] += w * a22
    to[n, 3, 0] += w * c00
    to[n, 3, 1] += w * c01
    to[n, 3, 2] += w * c02
    to[n, 3, 3] += w * m00
    to[n, 3, 4] += w * m01
    to[n, 3, 5] += w * m02
    to[n, 4, 0] += w * c10
    to[n, 4, 1] += w * c11
    to[n, 4, 2] += w * c12
    to[n, 4, 3] += w * m10
    to[n, 4, 4] += w * m11
    to[n, 4, 5] += w * m12
    to[n, 5, 0] += w * c20
    to[n, 5, 1] += w * c21
    to[n, 5, 2] += w * c22
    to[n, 5, 3] += w * m20
    to[n, 5, 4] += w * m21
    to[n, 5, 5] += w * m22


@compiled
def block_inverses(D: Floats) -> Floats:
    """(node, 6, 6) inverses of symmetric positive blocks (node, 6, 6), of which lower halves are read (Cholesky, D = L Lᵀ)."""
    out, L, W = np.empty_like(D), np.zeros((6, 6)), np.zeros((6, 6))
    for j in range(len(D)):
        for c in range(6):
            for r in range(c, 6):
                s = D[j, r, c]
                for k in range(c):
                    s -= L[r, k] * L[c, k]
                L[r, c] = np.sqrt(s) if r == c else s / L[c, c]
        for c in range(6):  # W = L⁻¹
            W[c, c] = 1.0 / L[c, c]
            for r in range(c + 1, 6):
                s = 0.0
                for k in range(c, r):
                    s -= L[r, k] * W[k, c]
                W[r, c] = s / L[r, r]
        for r in range(6):
            for c in range(r + 1):
                s = 0.0
                for k in range(r, 6):
                    s += W[k, r] * W[k, c]
                out[j, r, c] = out[j, c, r] = s
    return out


@compiled
def _times(D: Floats, B: Floats, pair: Ints, x: Floats, y: Floats) -> None:
    """Write the product of the system with x into y."""
    for j in range(len(D)):
        for a in range(6):
            s = 0.0
            for c in range(6):
                s += D[j, a, c] * x[j, c]
            y[j, a] = s
    for e in range(len(B)):
        j, k = pair[e, 0], pair[e, 1]
        # in registers: the compiler cannot know that the arrays do not overlap
        x0, x1, x2, x3, x4, x5 = x[k, 0], x[k, 1], x[k, 2], x[k, 3], x[k, 4], x[k, 5]
        y0, y1, y2, y3, y4, y5 = y[k, 0], y[k, 1], y[k, 2], y[k, 3], y[k, 4], y[k, 5]
        for a in range(6):
            t = x[j, a]
            b0, b1, b2, b3, b4, b5 = B[e, a, 0], B[e, a, 1], B[e, a, 2], B[e, a, 3], B[e, a, 4], B[e, a, 5]
            y[j, a] += b0 * x0 + b1 * x1 + b2 * x2 + b3 * x3 + b4 * x4 + b5 * x5
            y0, y1, y2, y3, y4, y5 = y0 + b0 * t, y1 + b1 * t, y2 + b2 * t, y3 + b3 * t, y4 + b4 * t, y5 + b5 * t
        y[k, 0], y[k, 1], y[k, 2], y[k, 3], y[k, 4], y[k, 5] = y0, y1, y2, y3, y4, y5


@compiled
def _precondition(inverse: Floats, r: Floats, z: Floats) -> float:
    """Write the preconditioned residual into z, and return its product with r."""
    total = 0.0
    for j in range(len(inverse)):
        for a in range(6):
            s = 0.0
            for c in range(6):
                s += inverse[j, a, c] * r[j, c]
            z[j, a] = s
            total += s * r[j, a]
    return total


@compiled
def conjugate_gradients(
    D: Floats, inverse: Floats, B: Floats, pair: Ints, b: Floats, iterations: int, tolerance: float
) -> Floats:
    """Solve by conjugate gradients, preconditioned by the inverses of the diagonal blocks.

    D, inverse : (node, 6, 6) · B : (block, 6, 6) above the diagonal at (block, 2) pair
    b          : (node, 6)
    tolerance  : stop when the preconditioned residual has fallen by this factor
    returns    : (node, 6)
    """
    x, r = np.zeros_like(b), b.copy()
    z, y = np.empty_like(b), np.empty_like(b)
    rz = _precondition(inverse, r, z)
    d = z.copy()
    least = tolerance * tolerance * rz
    for _ in range(iterations):
        if not rz > least:
            break
        _times(D, B, pair, d, y)
        curvature = 0.0
        for j in range(len(b)):
            for a in range(6):
                curvature += d[j, a] * y[j, a]
        if not curvature > 0.0:
            break
        step = rz / curvature
        for j in range(len(b)):
            for a in range(6):
                x[j, a] += step * d[j, a]
                r[j, a] -= step * y[j, a]
        before = rz
        rz = _precondition(inverse, r, z)
        for j in range(len(b)):
            for a in range(6):
                d[j, a] = z[j, a] + rz / before * d[j, a]
    return x
