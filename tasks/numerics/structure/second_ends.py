"""Ends beside the tip of a limb: a foot ends in its toes and in its heel, which is no extremum of μ (ours)."""

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.neighbours import ring_edges, rings
from kinetree.tasks.numerics.structure.end_effectors import from_border
from kinetree.tasks.numerics.topology.persistence import superlevel_peaks


class SecondEndsSettings(NamedTuple):
    """What counts as an end of its own; the height of a vertex is its distance from the border of its part."""

    prominence: float = 1 / 3
    """How far one must descend from it before a higher one can be reached, in radii of the border, at least. Chosen on one
    waving human, one wolf and three generated humans: heels have 0.56 to 0.89, chins and noses 0.19 at most."""
    height: float = 1 / 3
    """Its height, share of that of the part's tip, at least. Chosen on the same: heels have 0.55 to 0.69, chins 0.18."""


def second_ends(
    V: Floats,
    F: npt.NDArray[np.integer[Any]],
    label: Ints,
    parents: Ints,
    leaves: Ints,
    settings: SecondEndsSettings | None = None,
) -> Ints:
    """Where the last part of a limb stands out beside its tip.

    The tip is the part's leaf; a part without one has it where it is farthest from its border. Parts with two leaves or more,
    parts with another part below them and the root have no second ends.

    V, F    : (vertex, xyz) mesh unit · (face, corner)
    label   : (vertex,) part, parents : (part,) −1 for the root
    leaves  : (leaf,) vertices at the tips of limbs
    returns : (end,) vertices, by part, a part's most prominent first
    """
    limits = settings or SecondEndsSettings()
    start, ring = rings(np.array(F, np.int64), len(V))
    edge = ring_edges(start, ring)
    ends: list[int] = []
    for part in range(1, len(parents)):
        if (parents == part).any() or (label[leaves] == part).sum() > 1:
            continue
        border = np.unique(edge[(label[edge[:, 0]] == part) & (label[edge[:, 1]] != part), 0])
        if not len(border):
            continue
        radius = float(np.linalg.norm(V[border] - V[border].mean(axis=0), axis=1).mean())
        far = from_border(V, edge, label, part)
        high = superlevel_peaks(far, F, least=limits.prominence * radius).vertex
        if len(high) < 2:
            continue
        tip = V[[*leaves[label[leaves] == part], *high][0]]
        others = np.delete(high, np.linalg.norm(V[high] - tip, axis=1).argmin())
        ends += others[far[others] >= limits.height * far.max()].tolist()
    return np.array(ends, np.int64)
