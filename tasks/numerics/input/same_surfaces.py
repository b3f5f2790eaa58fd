"""Whether two takes show the same frames in other files: measures first, then vertices, as far as formats keep them (ours).

A copy is nearer to its original than the frames of a take are to each other. Two takes of a body that stands still are not:
they differ as its own frames do, by breath and noise of the sensor.
"""

from collections.abc import Callable, Sequence
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
    text by 1e-9."""
    change: float = 0.5
    """Distance of a copy from its original, share of the distance between frames of one take: 0.9 to 1.15 for two takes that
    stand still but for noise, 0.002 for Draco of 11 bits of six recorded bodies that move."""
    rounding: float = 1e-5
    """Distance that is a copy however little a take changes, share of the size: what text of six digits keeps."""
    changes: int = 8
    """Frames of a take of which it is found how much it changes."""
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


def have_same_frames(
    count: int,
    apart: Callable[[int, int], float],
    changed: Callable[[int, int], float],
    settings: SameSurfaceSettings | None = None,
) -> bool:
    """Whether every frame of a take is a copy of another one's at its place; frames are asked for until one is not.

    count   : frames of each
    apart   : `surface_distance` of a frame of one take and a frame of the other
    changed : the same of two frames of one take
    """
    limit = settings or SameSurfaceSettings()
    if not count or apart(0, 0) > limit.distance:
        return False
    steps = {1, count // 2} - {0, count}
    some = sorted({k * count // limit.changes for k in range(limit.changes)})
    change = float(np.median([max(changed(t, (t + step) % count) for step in steps) for t in some])) if steps else 0.0
    reach = max(limit.rounding, min(limit.distance, limit.change * change))
    return all(apart(t, t) <= reach for t in range(count))


def surface_distance(V: Floats, F: Faces, W: Floats, G: Faces) -> float:
    """Greatest distance of a vertex of one surface from the nearest of the other, either way, share of the size of the first.

    V, F and W, G : (vertex, xyz) mesh unit · (face, corner); vertices without a face do not count, their order neither
    """
    from scipy.spatial import cKDTree  # takes that differ in their measures do without

    X, Y = V[np.unique(F)], W[np.unique(G)]
    far = max(float(cKDTree(a).query(b)[0].max()) for a, b in ((X, Y), (Y, X)))
    return far / float(np.linalg.norm(np.ptp(X, axis=0)))
