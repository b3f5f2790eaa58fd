"""Limbs that are mirror images of each other, by distances over the surface (ours).

Most bodies have their limbs in pairs. The ends of a pair lie equally far from every other end, so that distances between ends
stay as they are when the two are exchanged; the pose changes them little. Which of three alike limbs are a pair nothing says.
"""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.components import largest_component
from kinetree.tasks.numerics.geometry.geodesic_distance import geodesic_distance
from kinetree.tasks.numerics.geometry.surface import Surface

ALIKE = 0.06
"""Root mean square change of the distances between all ends when two are exchanged, share of the longest, below which the two
are a pair. Pairs of people, humans and four-legged bodies have 0.003 to 0.037; two ends of a random tree may have as little."""

CLEAR = 0.5
"""That change in the change with the next best partner of either, at most. Pairs of people and humans have 0.04 to 0.3, of
recorded bodies 0.1 to 0.49."""
OTHERS = 0.03
"""That change with the next best partner, at least: of three alike limbs none is the other's mirror image. People and humans
have 0.085 and more, recorded bodies 0.036; a fore and a hind leg of a four-legged body may have less."""
FEWEST = 4
"""Ends of a body with pairs, at least. Two can always be exchanged, and of three one distance alone says whether two can."""


class LimbPairs(NamedTuple):
    """Ends of limbs, two by two.

    tip      : (pair, 2) vertices
    distance : (pair, 2, vertex) from each of them over the surface, mesh unit; infinite where no path leads
    """

    tip: Ints
    distance: Floats


NO_PAIRS = LimbPairs(np.zeros((0, 2), np.int64), np.zeros((0, 2, 0)))
"""Of a body without mirror images."""


def limb_pairs(V: Floats, F: Ints, leaves: Ints) -> LimbPairs:
    """Ends that are clearly each other's best partner; of the largest connected piece of the surface alone.

    V, F   : (vertex, xyz) mesh unit · (face, corner)
    leaves : (leaf,) vertices at the ends of limbs
    """
    piece, faces, _ = largest_component(V, F.astype(np.int32))
    tip = np.flatnonzero(np.isin(piece, leaves))
    if len(tip) < FEWEST:
        return LimbPairs(np.zeros((0, 2), np.int64), np.zeros((0, 2, len(V))))
    distance = np.full((len(tip), len(V)), np.inf)
    distance[:, piece] = geodesic_distance(Surface.of(V[piece], faces), tip)
    between = distance[:, piece[tip]]
    pair = _partners((between + between.T) / 2.0)
    return LimbPairs(piece[tip[pair]], distance[pair])


def _partners(between: Floats) -> Ints:
    """(pair, 2) ends that are clearly each other's best partner, the smaller number first; between (end, end) mesh unit."""
    count = len(between)
    change = np.full((count, count), np.inf)
    for a in range(count):
        for b in range(a):
            exchanged = np.arange(count)
            exchanged[[a, b]] = b, a
            square = ((between - between[np.ix_(exchanged, exchanged)]) ** 2).sum() / (count * (count - 1))
            change[a, b] = change[b, a] = np.sqrt(square) / between.max()
    best, next_best = change.argmin(axis=1), np.partition(change, 1, axis=1)[:, 1]
    clear = [
        (a, b)
        for a, b in enumerate(best.tolist())
        if a < b and change[a, b] < min(ALIKE, *(CLEAR * next_best[[a, b]])) and next_best[[a, b]].min() > OTHERS
    ]
    return np.array(clear, np.int64).reshape(-1, 2)
