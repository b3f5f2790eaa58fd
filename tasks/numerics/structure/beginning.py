"""Deliberately too many parts, to eliminate from: optimal runs of rings in the cones, merged patches elsewhere."""

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.geodesics import geodesic_distance
from kinetree.tasks.numerics.nodes import covering, nearest_nodes
from kinetree.tasks.numerics.structure.cones import cones
from kinetree.tasks.numerics.structure.moments import moments
from kinetree.tasks.numerics.structure.patches import merged
from kinetree.tasks.numerics.structure.segmentation import runs
from kinetree.tasks.numerics.surface import Surface

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

LEAST = 2  # rings in a run


def cone_runs(
    surface: Surface, V: Floats, x: Floats, weight: Floats, leaves: Ints, start: Ints, ring: Ints, count: int, cut: float
) -> Ints:
    """Rigid runs of rings around every leaf.

    surface     : its lengths may be in another unit than the rest
    V, x        : (vertex, xyz) · (frame, vertex, xyz) mesh unit, near the origin
    weight      : (frame, vertex) belief times area
    leaves      : (leaf,) vertices
    start, ring : neighbours of every vertex
    count       : rings in the longest distance from each leaf
    cut         : root mean square residual that makes a tenth of the rings worth a run of their own, mesh unit
    returns     : (vertex,) run, −1 where there is no cone or there are several
    """
    label = np.full(len(V), -1, np.int64)
    if not len(leaves):
        return label
    C = cones(geodesic_distance(surface, leaves, exact=0.0), surface.area, leaves, start, ring, count)
    alone = (C >= 0).sum(axis=0) == 1
    total = 0
    for cone in C:
        mine = alone & (cone >= 0)
        if not mine.any():
            continue
        M = moments(V, x, weight, cone, int(cone.max()) + 1)
        usual = float(np.median(M[:, :, 0].mean(axis=1)))
        run = runs(M, len(x) * cut**2 * usual * count / 5, LEAST)
        label[mine] = total + run[cone[mine]]
        total += int(run.max()) + 1
    return label


def patch_groups(
    surface: Surface,
    V: Floats,
    x: Floats,
    weight: Floats,
    where: npt.NDArray[np.bool_],
    start: Ints,
    ring: Ints,
    count: int,
    left: int,
) -> Ints:
    """Patches of part of the surface, merged while they move as one.

    where   : (vertex,) the part of the surface
    count   : patches the whole surface is cut into
    left    : groups to leave
    returns : (vertex,) group, −1 elsewhere
    """
    group = np.full(len(V), -1, np.int64)
    if not where.any():
        return group
    node = covering(surface, np.ones(len(V)), count)
    cell = nearest_nodes(surface, node, 1)[0][:, 0]
    used, patch = np.unique(cell[where], return_inverse=True)
    group[where] = patch.reshape(-1)
    M = moments(V, x, weight, group, len(used))
    pairs = np.stack([np.repeat(group, np.diff(start)), group[ring]], axis=1)
    pairs = np.unique(pairs[(pairs[:, 0] >= 0) & (pairs[:, 0] < pairs[:, 1])], axis=0)
    group[where] = merged(M, pairs, left)[group[where]]
    return group
