"""Cotangent weights of the edges of a mesh, safe for obtuse and thin triangles (Pinkall, Polthier 1993; for 2014, Sec. 5.3)."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.neighbours import rings

_LEAST_WEIGHT = 0.01
"""Least weight of an edge, share of 1/√3, the weight between two equilateral triangles."""
_LARGEST_COTANGENT = 20.0
"""Corners below 3° count as if they had 3°."""


class Links(NamedTuple):
    """Every vertex's neighbours over edges, both ways.

    start  : (vertex + 1,) where each vertex's begin
    ring   : (entry,) the neighbours, ascending
    weight : (entry,) above 0, equal both ways, without unit
    """

    start: Ints
    ring: Ints
    weight: Floats


def cotangent_links(V: Floats, F: npt.NDArray[np.integer]) -> Links:
    """Weights w = ½ (cot α + cot β), α and β opposite the edge, never below a small positive number.

    Where the angles opposite an edge sum to more than half a turn, the plain weight is negative and an energy with it
    has no minimum; clamped, every term is a cost. Of meshes whose edges are Delaunay nothing is changed.

    V, F    : (vertex, xyz) mesh unit · (face, corner); a face without area and edges of three faces are accepted
    returns : Links; a vertex in no face has no neighbours
    """
    corners: Ints = np.asarray(F, np.int64)
    start, ring = rings(corners, len(V))
    tail = np.repeat(np.arange(len(V)), np.diff(start))
    code = tail * len(V) + ring
    weight = np.zeros(len(code))
    for corner in range(3):
        a, b, c = (corners[:, (corner + k) % 3] for k in range(3))
        half = _cotangents(V[b] - V[a], V[c] - V[a]) / 2.0
        for one, other in ((b, c), (c, b)):
            weight += np.bincount(np.searchsorted(code, one * len(V) + other), half, len(code))
    return Links(start, ring, np.maximum(weight, _LEAST_WEIGHT / np.sqrt(3.0)))


def _cotangents(e: Floats, f: Floats) -> Floats:
    """(face,) cotangent of the angle between two edges; of nought, if one has no length."""
    along = np.einsum("fx,fx->f", e, f)
    across = np.linalg.norm(np.cross(e, f), axis=1)
    return np.clip(
        np.divide(along, across, out=np.zeros_like(along), where=across > 0), -_LARGEST_COTANGENT, _LARGEST_COTANGENT
    )
