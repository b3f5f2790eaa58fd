"""The Morton curve through space: points that are near each other along it are near each other in space (Morton 1966)."""

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints

SURFACE_BITS = 10
"""Bits a side of the grid by which a surface's vertices are numbered; finer cells than edges gain nothing."""
SAMPLE_BITS = 7
"""Bits a side of the grid along which samples are spread: cells near a hundredth of the body, as wide as an edge."""


def morton_order(V: Floats) -> Ints:
    """Vertices sorted along the curve, so that neighbours lie close in memory; those of one cell keep their order.

    V       : (vertex, xyz) any unit
    returns : (vertex,) vertex numbers
    """
    low = V.min(axis=0) if len(V) else np.zeros(3)
    extent = max(float(np.ptp(V)), np.finfo(float).tiny) if len(V) else 1.0
    side = 2**SURFACE_BITS
    return np.argsort(_morton_code(np.minimum((V - low) / extent * side, side - 1).astype(np.int64)), kind="stable")


def spread_along_curve(V: Floats, count: int) -> Ints:
    """Vertices spread through space: every so many along the curve, in whatever order the mesh lists them.

    V       : (vertex, xyz) any unit
    count   : wanted, all if there are fewer
    returns : (sample,) vertex numbers in the order of the curve
    """
    extent = max(float(np.ptp(V, axis=0).max()), np.finfo(float).tiny)
    cell = ((V - V.min(axis=0)) / extent * (2**SAMPLE_BITS - 1)).astype(np.int64)
    order = np.lexsort((V[:, 2], V[:, 1], V[:, 0], _morton_code(cell)))
    return order[np.arange(min(count, len(V))) * len(V) // min(count, len(V))]


def _morton_code(cell: Ints) -> Ints:
    """(vertex,) the bits of three numbers below 1,024 (vertex, xyz) by turns, x first."""
    for shift, mask in ((16, 0x030000FF), (8, 0x0300F00F), (4, 0x030C30C3), (2, 0x09249249)):
        cell = (cell | cell << shift) & mask
    return cell @ np.array([1, 2, 4])
