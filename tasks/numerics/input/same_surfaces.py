"""Whether two takes show the same frames in other files: measures first, then vertices, as far as formats keep them (ours)."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Faces, Floats
from kinetree.tasks.numerics.input.bad_frames import FrameMeasures


class SameSurfaceSettings(NamedTuple):
    """How far the same surface may differ from file to file."""

    measure: float = 1e-2
    """Share by which area and volume may differ; Draco of 11 bits changes them by 0.0016 at most, of three bodies."""
    distance: float = 1e-3
    """Distance of a vertex from the nearest of the other surface, share of the size; Draco of 11 bits moves it by 0.00035,
    text by 1e-9. Takes that differ by less show nothing new."""
    middle: float = 1e-2
    """Difference of size and centre, share of the size; Draco of 11 bits changes the centre by 0.0009 at most. It is a median
    over faces, and jumps where they are few."""


def have_same_measures(
    some: Sequence[FrameMeasures], others: Sequence[FrameMeasures], settings: SameSurfaceSettings | None = None
) -> bool:
    """Whether each frame of one take may be the frame of another at its place: as large, and at the same place.

    some, others : of the frames in their order; what is no mesh yet has none, and is never the same
    """
    limit = settings or SameSurfaceSettings()
    if not some or len(some) != len(others):
        return False
    of = [np.array([[m.area, m.volume, m.size, *m.centre] for m in measures]) for measures in (some, others)]
    size = np.minimum(of[0][:, 2:3], of[1][:, 2:3])
    reach = np.hstack([limit.measure * np.minimum(of[0], of[1])[:, :2], np.repeat(limit.middle * size, 4, axis=1)])
    return bool((np.abs(of[0] - of[1]) <= reach).all())


def have_same_vertices(V: Floats, F: Faces, W: Floats, G: Faces, settings: SameSurfaceSettings | None = None) -> bool:
    """Whether every vertex of a surface lies at one of another and the other way round; their order does not matter.

    V, F and W, G : (vertex, xyz) mesh unit · (face, corner); vertices without a face do not count
    """
    from scipy.spatial import cKDTree  # takes that differ in their measures do without

    limit = settings or SameSurfaceSettings()
    X, Y = V[np.unique(F)], W[np.unique(G)]
    reach = limit.distance * float(np.linalg.norm(np.ptp(X, axis=0)))
    return all(float(cKDTree(a).query(b)[0].max()) <= reach for a, b in ((X, Y), (Y, X)))
