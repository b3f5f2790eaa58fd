"""What is known of one interval's reference brought to the others: the way over the cuts, labels, places (2014, Sec. 6.1.3)."""

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.paper_2014.bones import Areas

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


def way(onward: list[Ints], backward: list[Ints], start: int, goal: int, vertices: int) -> Ints:
    """The vertex of interval `goal` at each vertex of interval `start`, over all cuts between.

    onward, backward : of each cut, (vertex,) of the interval before it, in the one behind; the reverse; −1 for none
    vertices         : of interval `start`
    returns          : (vertex,) −1 where the way is broken
    """
    at = np.arange(vertices)
    for step in range(start, goal) if goal > start else range(start - 1, goal - 1, -1):
        onto = onward[step] if goal > start else backward[step]
        at = np.where(at >= 0, onto[at], -1)
    return at


def labels(found: Areas, cones: int, ring: Ints, home: Ints) -> Ints:
    """The areas of one interval's reference: those of cones by annulus index, all others by the way over the cuts.

    cones   : how many of the pieces are cones, which come first, one a limb
    ring    : (limb, vertex) annuli of the interval's own cones
    home    : (vertex,) the vertex of the reference on which the areas are known, −1 for none
    returns : (vertex,) area, −1 where nobody knows
    """
    over = np.where(home >= 0, found.label[home], -1)
    own = np.full(ring.shape, -1)
    for area in np.flatnonzero(found.piece < cones):
        limb = int(found.piece[area])
        own[limb, (ring[limb] >= found.first[area]) & (ring[limb] <= found.last[area])] = area
    claims = (own >= 0).sum(axis=0)
    of_cone = (over >= 0) & (found.piece[over] < cones)
    return np.where(claims == 1, own.max(axis=0, initial=-1), np.where((claims == 0) & of_cone, -1, over))


def centroids(x: Floats, label: Ints, area: Floats, count: int) -> Floats:
    """(frame, area, xyz) middle of the surface of each area; NaN where an area has none.

    x    : (frame, vertex, xyz) mesh unit
    label, area : (vertex,) area, −1 for none · mesh unit²
    """
    out = np.full((len(x), count, 3), np.nan)
    for a in range(count):
        mine = (label == a) & (area > 0.0)
        if mine.any():
            out[:, a] = np.einsum("v,tvx->tx", area[mine] / area[mine].sum(), x[:, mine])
    return out


def carried(x: Floats, to: Ints) -> Floats:
    """(…, vertex, xyz) where the vertices that each one became are; NaN where the way is broken.

    x  : (…, other, xyz) mesh unit
    to : (vertex,) see `way`
    """
    return np.where((to >= 0)[:, None], x[..., to, :], np.nan)
