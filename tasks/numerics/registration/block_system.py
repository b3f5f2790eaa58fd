"""A symmetric system of 6 × 6 blocks, one unknown turn and shift per node: assembled pair by pair, solved by PCG.

Every row of data touches at most four nodes, so its part of JᵀJ is ten blocks that are added directly; no sparse
Jacobian is ever formed. All sums run in a fixed order on one thread.
"""

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.geometry.neighbours import distinct


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


@compiled
def _add_row(
    D: Floats, B: Floats, b: Floats, rest: Floats, bound: Ints, weight: Floats, of_vertex: Ints,
    R: Floats, g: Floats, v: int, f: Floats, M: Floats, A: Floats, q: Floats,
) -> None:  # fmt: skip
    """One row with form M (3, 3) and slope f (xyz); A (4, 3, 3) and q (4, 3) are room to work in."""
    for k in range(4):
        j, w = bound[v, k], weight[v, k]
        d0, d1, d2 = rest[v, 0] - g[j, 0], rest[v, 1] - g[j, 1], rest[v, 2] - g[j, 2]
        for x in range(3):
            q[k, x] = R[j, x, 0] * d0 + R[j, x, 1] * d1 + R[j, x, 2] * d2
        for y in range(3):
            A[k, 0, y] = q[k, 1] * M[2, y] - q[k, 2] * M[1, y]
            A[k, 1, y] = q[k, 2] * M[0, y] - q[k, 0] * M[2, y]
            A[k, 2, y] = q[k, 0] * M[1, y] - q[k, 1] * M[0, y]
        b[j, 0] -= w * (q[k, 1] * f[2] - q[k, 2] * f[1])
        b[j, 1] -= w * (q[k, 2] * f[0] - q[k, 0] * f[2])
        b[j, 2] -= w * (q[k, 0] * f[1] - q[k, 1] * f[0])
        for x in range(3):
            b[j, 3 + x] -= w * f[x]
    pair = 0
    for k in range(4):
        j = bound[v, k]
        _add(D[j], A[k], A[k], q[k], M, weight[v, k] * weight[v, k])
        for m in range(k + 1, 4):
            w = weight[v, k] * weight[v, m]
            block = of_vertex[v, pair]
            pair += 1
            if w == 0.0:
                continue
            if block >= 0:
                _add(B[block], A[k], A[m], q[m], M, w)
            else:
                _add(D[j], A[k], A[m], q[m], M, w)
                _add(D[j], A[m], A[k], q[k], M, w)


@compiled
def _add(block: Floats, A: Floats, other: Floats, q: Floats, M: Floats, w: float) -> None:
    """Add w · J_jᵀ M J_k with J = [−[q]×, 1]: its turn-turn part is A_j [q_k]×ᵀ, whose rows are q_k × row."""
    for x in range(3):
        block[x, 0] += w * (q[1] * A[x, 2] - q[2] * A[x, 1])
        block[x, 1] += w * (q[2] * A[x, 0] - q[0] * A[x, 2])
        block[x, 2] += w * (q[0] * A[x, 1] - q[1] * A[x, 0])
        for y in range(3):
            block[x, 3 + y] += w * A[x, y]
            block[3 + x, y] += w * other[y, x]
            block[3 + x, 3 + y] += w * M[x, y]


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
        for a in range(6):
            s, t = 0.0, x[j, a]
            for c in range(6):
                s += B[e, a, c] * x[k, c]
                y[k, c] += B[e, a, c] * t
            y[j, a] += s


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
