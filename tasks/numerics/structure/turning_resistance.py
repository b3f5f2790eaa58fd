"""How firmly the surface of a joint's parts resists turning about the joint (slippage analysis, Gelfand and Guibas 2004).

A part that is round about an axis slides along itself when it turns about that axis. A joint of such a part lies on the axis;
the farther it lies off, the less of a slide a turn about it is. So the resistance says of a place what no motion says.
"""

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.normals import smoothed_normals
from kinetree.tasks.numerics.geometry.surface import surface_areas

FEWEST = 6
"""Vertices of a part, at least: a turn has three freedoms."""


def turning_resistance(V: Floats, F: Ints, label: Ints, parents: Ints, rest: Floats) -> Floats:
    """The smaller resistance of the two parts that meet at each joint.

    V, F    : (vertex, xyz) reference, mesh unit · (face, corner)
    label   : (vertex,) joint whose rigid part a vertex belongs to, −1 for none
    parents : (joint,) −1 for the root
    rest    : (joint, xyz) in the reference, mesh unit
    returns : (joint,) 0 to 1/3; NaN for the root, and where neither part has enough vertices
    """
    N, area = smoothed_normals(V, F), surface_areas(V, F)
    order = np.argsort(label, kind="stable")
    start = np.searchsorted(label[order], np.arange(len(parents) + 1))
    of_part = [order[start[j] : start[j + 1]] for j in range(len(parents))]
    least = np.full(len(parents), np.nan)
    for joint in np.flatnonzero(parents >= 0):
        parts = [of_part[q] for q in (joint, parents[joint]) if len(of_part[q]) >= FEWEST]
        if parts:
            least[joint] = min(resistance_about(V[own] - rest[joint], N[own], area[own]) for own in parts)
    return least


def resistance_about(P: Floats, N: Floats, area: Floats) -> float:
    """Smallest eigenvalue of Σ a (p × n)(p × n)ᵀ / Σ a |p|², over points p of a surface, from the point that is held.

    P, N    : (vertex, xyz) mesh unit · (vertex, xyz) unit normals
    area    : (vertex,) mesh unit²
    returns : 0 where a turn about some axis through the point slides the surface along itself, 1/3 at most
    """
    moment = np.cross(P, N)
    extent = max(float(area @ np.square(P).sum(axis=1)), np.finfo(np.float64).tiny)
    return max(float(np.linalg.eigvalsh(np.einsum("v,vx,vy->xy", area, moment, moment))[0]) / extent, 0.0)
