"""Triangles unfolded into the plane of a virtual source (Trettner, Bommes, Kobbelt 2021), a block of them at a time.

Two vertices of a triangle know their distances; the point of the plane at these distances is the virtual source, and
the third vertex is as far as its straight line to it, if that line crosses the edge between the two. If it passes
beside that edge, the line enters the neighbouring triangle, which is unfolded into the same plane, and so on.
A virtual source is not carried along but found anew from the distances, so that noise on the surface, whose every
vertex splits a carried source in two, averages out.

A block is one flat array of rows of BLOCK numbers. The constant stride lets the compiler see that rows do not overlap,
so that the loops over numbers become vector instructions; indices are unsigned because numba otherwise guards every
access against counting from the end.
"""

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.compiled import compiled

Floats = npt.NDArray[np.float64]
Lengths = npt.NDArray[np.float32]
Indices = npt.NDArray[np.uint32]

BLOCK = 256
_0, _1, _2, _3 = np.uint64(0), np.uint64(1), np.uint64(2), np.uint64(3)

# rows: radii of the edge's ends, the triangle's three sides, distance of the bend behind the virtual source
NEAR, OTHER, BASE, SIDE, RIM, SIGMA = (np.uint64(row * BLOCK) for row in range(6))
# the virtual source below the edge, the third vertex above it, its distance, where its line passes the edge
X, Y, CX, CY, REACH, FROM_LEFT, FROM_RIGHT = (np.uint64(row * BLOCK) for row in range(6, 13))
# rows of a block under way: the edge to be crossed from left to right, and the first edge's right end
AX, AY, BX, BY, WIDTH = (np.uint64(row * BLOCK) for row in range(13, 18))
ROWS = 18


@compiled
def unfold_first(count: np.uint64, W: Floats) -> None:
    """Virtual source and third vertex of `count` triangles, from rows NEAR … SIGMA to rows X … FROM_RIGHT of W.

    The edge lies on the x axis from its NEAR end at 0 to its OTHER end at BASE; the line to the third vertex crosses
    it if FROM_LEFT ≥ 0 and FROM_RIGHT ≥ 0. Y = 0 where no point has both distances.
    """
    for i in range(count):
        near, other, base, side, rim = W[i + NEAR], W[i + OTHER], W[i + BASE], W[i + SIDE], W[i + RIM]
        inverse = 1.0 / base
        x = 0.5 * (base + (near - other) * (near + other) * inverse)
        y = np.sqrt(max(near * near - x * x, 0.0))
        cx = 0.5 * (base + (side - rim) * (side + rim) * inverse)
        cy = np.sqrt(max(side * side - cx * cx, 0.0))
        foot = x * cy + cx * y
        W[i + X], W[i + Y], W[i + CX], W[i + CY] = x, y, cx, cy
        W[i + REACH] = W[i + SIGMA] + np.sqrt((cx - x) * (cx - x) + (cy + y) * (cy + y))
        W[i + FROM_LEFT] = foot
        W[i + FROM_RIGHT] = base * (y + cy) - foot


@compiled
def unfold_next(count: np.uint64, code: Indices, length: Lengths, W: Floats) -> None:
    """Third vertex of the triangle beyond each edge A B, seen from the same virtual source through the first edge.

    code : (i,) 2 × half-edge + 1 if the plane shows the faces from outside, so that the half-edge runs from A to B
    """
    for i in range(count):
        h = np.uint64(code[i]) >> _1
        corner = h // _3 * _3
        before = h + _2 if h == corner else h - _1
        after = _3 * corner + _3 - h - before
        outside = (np.uint64(code[i]) & _1) == _1
        W[i + BASE] = length[h]
        W[i + SIDE] = length[before if outside else after]
        W[i + RIM] = length[after if outside else before]
    for i in range(count):
        ax, ay, x, y = W[i + AX], W[i + AY], W[i + X], W[i + Y]
        side, rim = W[i + SIDE], W[i + RIM]
        inverse = 1.0 / (W[i + BASE] * W[i + BASE])
        along = 0.5 + 0.5 * (side - rim) * (side + rim) * inverse
        above = np.sqrt(max(side * side * inverse - along * along, 0.0))
        cx = ax + (W[i + BX] - ax) * along - (W[i + BY] - ay) * above
        cy = ay + (W[i + BY] - ay) * along + (W[i + BX] - ax) * above
        W[i + CX], W[i + CY] = cx, cy
        W[i + REACH] = W[i + SIGMA] + np.sqrt((cx - x) * (cx - x) + (cy + y) * (cy + y))
        W[i + FROM_LEFT] = x * (cy + y) + y * (cx - x)
        W[i + FROM_RIGHT] = (W[i + WIDTH] - x) * (cy + y) - y * (cx - x)


@compiled
def leave_first(
    count: np.uint64, code: Indices, ring_edge: Indices, opening: Indices, W: Floats, passing: Indices
) -> np.uint64:
    """Triangles whose line passes beside the edge go on to the neighbour it enters; how many there are.

    code    : (i,) 2 × ring entry + 1 if the edge's OTHER end is the entry before
    passing : (i,) filled with the code for `unfold_next`
    """
    kept = _0
    for k in range(count):
        passing[kept] = k
        kept += np.uint64((W[k + Y] > 0.0) & ((W[k + FROM_LEFT] < 0.0) | (W[k + FROM_RIGHT] < 0.0)))
    going, borders = _0, np.uint64(opening.size)
    for k in range(kept):
        i = np.uint64(passing[k])
        outside = np.uint64(code[i]) & _1
        h = np.uint64(ring_edge[np.uint64(code[i]) >> _1])
        left = W[i + FROM_LEFT] < 0.0
        corner = h // _3 * _3
        side = h - corner + (_1 if left else outside + outside)
        across = np.uint64(opening[corner + (side if side < _3 else side - _3)])
        x, y, cx, cy, base, sigma = W[i + X], W[i + Y], W[i + CX], W[i + CY], W[i + BASE], W[i + SIGMA]
        # rows are compacted in place: entry `going` is never ahead of the one being read
        W[going + AX] = cx if left else 0.0
        W[going + AY] = cy if left else 0.0
        W[going + BX] = base if left else cx
        W[going + BY] = 0.0 if left else cy
        W[going + WIDTH], W[going + X], W[going + Y], W[going + SIGMA] = base, x, y, sigma
        passing[going] = (across << _1) | outside
        going += np.uint64(across < borders)
    return going


@compiled
def leave_next(count: np.uint64, twin: Indices, W: Floats, passing: Indices) -> np.uint64:
    """The same after `unfold_next`: lines that still miss go on through the edge they cross; how many there are."""
    going, borders = _0, np.uint64(twin.size)
    for i in range(count):
        outside = np.uint64(passing[i]) & _1
        h = np.uint64(passing[i]) >> _1
        left = W[i + FROM_LEFT] < 0.0
        out = left | (W[i + FROM_RIGHT] < 0.0)
        ax, ay, bx, by, width = W[i + AX], W[i + AY], W[i + BX], W[i + BY], W[i + WIDTH]
        x, y, cx, cy, sigma = W[i + X], W[i + Y], W[i + CX], W[i + CY], W[i + SIGMA]
        W[going + AX] = cx if left else ax
        W[going + AY] = cy if left else ay
        W[going + BX] = bx if left else cx
        W[going + BY] = by if left else cy
        W[going + WIDTH], W[going + X], W[going + Y], W[going + SIGMA] = width, x, y, sigma
        corner = h // _3 * _3
        before = h + _2 if h == corner else h - _1
        after = _3 * corner + _3 - h - before
        across = np.uint64(twin[after if np.uint64(left) == outside else before])
        passing[going] = (across << _1) | outside
        going += np.uint64(out & (across < borders))
    return going
