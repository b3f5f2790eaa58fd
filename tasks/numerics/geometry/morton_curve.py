"""The Morton curve through space: points that are near each other along it are near each other in space (Morton 1966)."""

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.compiled import compiled

SURFACE_BITS = 10
"""Bits a side of the grid by which a surface's vertices are numbered; finer cells than edges gain nothing."""
SAMPLE_BITS = 7
"""Bits a side of the grid along which samples are spread: cells near a hundredth of the body, as wide as an edge."""

_DIGIT = 10
"""Bits of the code that are sorted by at a time."""
_FULL = 256
"""Vertices in one cell up to which it is sorted one after the other; a far point of dirt can put all others into one."""


def morton_order(V: Floats) -> Ints:
    """Vertices sorted along the curve, so that neighbours lie close in memory; those of one cell keep their order.

    V       : (vertex, xyz) any unit
    returns : (vertex,) vertex numbers
    """
    low = V.min(axis=0) if len(V) else np.zeros(3)
    extent = max(float(np.ptp(V)), np.finfo(float).tiny) if len(V) else 1.0
    side = 2**SURFACE_BITS
    return _sorted(_morton_code(np.minimum((V - low) / extent * side, side - 1).astype(np.int64)), 3 * SURFACE_BITS)


def spread_along_curve(V: Floats, count: int) -> Ints:
    """Vertices spread through space: every so many along the curve, in whatever order the mesh lists them.

    V       : (vertex, xyz) any unit
    count   : wanted, all if there are fewer
    returns : (sample,) vertex numbers in the order of the curve
    """
    extent = max(float(np.ptp(V, axis=0).max()), np.finfo(float).tiny)
    cell = ((V - V.min(axis=0)) / extent * (2**SAMPLE_BITS - 1)).astype(np.int64)
    code = _morton_code(cell)
    order = _sorted(code, 3 * SAMPLE_BITS)
    if _fullest_cell(code, order) > _FULL:
        order = np.lexsort((V[:, 2], V[:, 1], V[:, 0], code))
    else:
        _sort_cells(order, code, np.ascontiguousarray(V, np.float64))
    return order[np.arange(min(count, len(V))) * len(V) // min(count, len(V))]


@compiled
def _morton_code(cell: Ints) -> Ints:
    """(vertex,) the bits of three numbers below 1,024 (vertex, xyz) by turns, x first."""
    out = np.zeros(len(cell), np.int64)
    for i in range(len(cell)):
        for x in range(3):
            bits = cell[i, x]
            bits = (bits | bits << 16) & 0x030000FF
            bits = (bits | bits << 8) & 0x0300F00F
            bits = (bits | bits << 4) & 0x030C30C3
            bits = (bits | bits << 2) & 0x09249249
            out[i] += bits << x
    return out


@compiled
def _sorted(code: Ints, bits: int) -> Ints:
    """(vertex,) order by code; equal codes keep their order. By digits, the last first (Knuth 1998, Sec. 5.2.5)."""
    order, other = np.arange(len(code)), np.empty(len(code), np.int64)
    for shift in range(0, bits, _DIGIT):
        begin = np.zeros(2**_DIGIT + 1, np.int64)
        for c in code:
            begin[((c >> shift) & (2**_DIGIT - 1)) + 1] += 1
        for d in range(2**_DIGIT):
            begin[d + 1] += begin[d]
        for i in order:
            d = (code[i] >> shift) & (2**_DIGIT - 1)
            other[begin[d]] = i
            begin[d] += 1
        order, other = other, order
    return order


@compiled
def _fullest_cell(code: Ints, order: Ints) -> int:
    """How many vertices have the same code, at most."""
    most, run = min(len(order), 1), 1
    for k in range(1, len(order)):
        run = run + 1 if code[order[k]] == code[order[k - 1]] else 1
        most = max(most, run)
    return most


@compiled
def _sort_cells(order: Ints, code: Ints, V: Floats) -> None:
    """Sorts in place vertices of equal code by x, then y, then z, then number, one after the other: for cells of few."""
    for k in range(1, len(order)):
        i, place = order[k], k
        while place > 0 and code[order[place - 1]] == code[i] and _is_before(V, i, order[place - 1]):
            order[place] = order[place - 1]
            place -= 1
        order[place] = i


@compiled
def _is_before(V: Floats, i: int, j: int) -> bool:
    for x in range(3):
        if V[i, x] != V[j, x]:
            return bool(V[i, x] < V[j, x])
    return False
