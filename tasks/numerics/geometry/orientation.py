"""Which side of a surface is out: neighbouring faces made to agree, closed patches turned outwards, winding numbers."""

import numpy as np

from kinetree.tasks.numerics.arrays import Faces, Flags, Floats, Ints
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.geometry.normals import area_vectors

_FLAT_OPEN = 0.01
"""Volume over area^1.5 (a sphere has 0.094) below which an open patch is flat and has no outside to turn to."""
_FLAT_CLOSED = 1e-9
"""The same for a closed patch, where only rounding error is left of the volume."""


def oriented(X: Floats, F: Faces) -> tuple[Flags, Ints]:
    """Which faces to turn so that neighbours agree and closed patches face outwards, and each face's component.

    A patch is what edges of exactly two faces connect. A closed patch is turned to positive volume; so is an open one
    that clearly encloses some about its centroid; a flat one keeps the side that most of its area had.

    X, F    : (vertex, xyz) · (face, corner) without repeated corners or faces
    returns : (face,) · (face,) component by shared edges, numbered in the order of first faces
    """
    order = lexicographic(half_edges(F), len(X))
    root, flip, is_open, component_root = _patches(F, order)
    patch = _numbered(root)
    sign = 1.0 - 2.0 * flip
    N = area_vectors(X, F)
    area = np.linalg.norm(N, axis=1)
    A = np.bincount(patch, weights=area)
    moment = np.stack([np.bincount(patch, weights=area * x) for x in X[F].mean(axis=1).T], axis=1)
    centroid = moment / np.where(A > 0, A, 1.0)[:, None]
    height = np.einsum("fx,fx->f", X[F[:, 0]] - centroid[patch], N)
    volume = np.bincount(patch, weights=sign * height) / 3
    majority = np.bincount(patch, weights=sign * area)
    # a closed patch pressed flat has a volume of rounding error, whose sign a second cleaning might not find again
    encloses = np.abs(volume) > np.where(np.bincount(patch, weights=is_open) > 0, _FLAT_OPEN, _FLAT_CLOSED) * A**1.5
    turned = np.where(encloses, volume, majority)[patch] * sign < 0
    # nothing to go by (a patch without area or volume): the first face of the patch decides
    turned |= (np.where(encloses, volume, majority)[patch] == 0) & flip
    return turned, _numbered(component_root)


def winding(P: Floats, X: Floats, F: Faces) -> Floats:
    """How often the surface winds round each point: 1 inside a closed one that faces outwards, 0 outside.

    Solid angles after Van Oosterom and Strackee 1983.

    P, X, F : (point, xyz) off the surface · (vertex, xyz) · (face, corner)
    returns : (point,)
    """
    return _winding(np.ascontiguousarray(P), np.ascontiguousarray(X), np.ascontiguousarray(F))


def half_edges(F: Faces) -> Faces:
    """(3 · face, end) ends, the smaller first, of half-edge 3f + k from corner k of face f to the next."""
    H = F[:, [1, 2, 0]]
    return np.stack([np.minimum(F, H), np.maximum(F, H)], axis=2).reshape(-1, 2)


def _numbered(root: Ints) -> Ints:
    """Labels 0, 1, … instead of roots, in the order of the roots."""
    return (np.cumsum(root == np.arange(len(root))) - 1)[root]


@compiled
def lexicographic(rows: Faces, n: int) -> Ints:
    """Stable order of the rows of integers in [0, n): a counting sort per column, linear in rows + n."""
    order = np.arange(len(rows))
    for column in range(rows.shape[1] - 1, -1, -1):
        begin = np.zeros(n + 1, dtype=np.int64)
        for value in rows[:, column]:
            begin[value + 1] += 1
        begin = np.cumsum(begin)
        placed = np.empty_like(order)
        for row in order:
            placed[begin[rows[row, column]]] = row
            begin[rows[row, column]] += 1
        order = placed
    return order


@compiled
def _find(parent: Ints, flip: Flags, f: int) -> int:
    """Root of face f; afterwards f hangs from it directly and flip[f] is relative to it."""
    root, relative = f, False
    while parent[root] != root:
        relative ^= flip[root]
        root = parent[root]
    while parent[f] != root and f != root:
        parent[f], flip[f], f, relative = root, relative, parent[f], relative ^ flip[f]
    return root


@compiled
def _patches(F: Faces, order: Ints) -> tuple[Ints, Flags, Flags, Ints]:
    """Per face: root of its patch, flip relative to it, whether it has an open end, root of its component.

    Edges are joined in the order of their vertices: where a surface cannot be oriented the cut does not depend on
    which way faces were turned before, so that a second cleaning finds nothing to turn.
    """
    m = len(F)
    patch, flip, component, unused = np.arange(m), np.zeros(m, np.bool_), np.arange(m), np.zeros(m, np.bool_)
    is_open = np.zeros(m, np.bool_)
    i = 0
    while i < 3 * m:
        f, k = order[i] // 3, order[i] % 3
        a, b = F[f, k], F[f, (k + 1) % 3]
        j = i + 1
        while j < 3 * m:
            g, k = order[j] // 3, order[j] % 3
            c, d = F[g, k], F[g, (k + 1) % 3]
            if min(a, b) != min(c, d) or max(a, b) != max(c, d):
                break
            p, q = _find(component, unused, f), _find(component, unused, g)
            component[max(p, q)] = min(p, q)
            j += 1
        if j - i == 2:
            g, k = order[i + 1] // 3, order[i + 1] % 3
            p, q = _find(patch, flip, f), _find(patch, flip, g)
            differ = (a == F[g, k]) ^ flip[f] ^ flip[g]
            if p != q:
                patch[max(p, q)] = min(p, q)
                flip[max(p, q)] = differ
            else:
                is_open[f] |= differ
        else:
            for h in range(i, j):
                is_open[order[h] // 3] = True
        i = j
    for f in range(m):
        patch[f], component[f] = _find(patch, flip, f), _find(component, unused, f)
    return patch, flip, is_open, component


@compiled
def _winding(P: Floats, X: Floats, F: Faces) -> Floats:
    out = np.zeros(len(P))
    for i in range(len(P)):
        total = 0.0
        for f in range(len(F)):
            a, b, c = X[F[f, 0]] - P[i], X[F[f, 1]] - P[i], X[F[f, 2]] - P[i]
            la, lb, lc = np.sqrt((a * a).sum()), np.sqrt((b * b).sum()), np.sqrt((c * c).sum())
            determinant = (
                a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
            )
            dots = la * lb * lc + (a * b).sum() * lc + (b * c).sum() * la + (c * a).sum() * lb
            total += np.arctan2(determinant, dots)
        out[i] = total / (2 * np.pi)
    return out
