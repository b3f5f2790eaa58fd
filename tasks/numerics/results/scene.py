"""A moving body reduced to what a page can hold: fewer frames, positions as 16-bit numbers, one colour a part."""

from typing import NamedTuple

import networkx as nx
import numpy as np
import numpy.typing as npt

from kinetree.tasks.numerics.arrays import Floats, Ints

LARGEST_LEVEL = 65535
"""Largest 16-bit number."""


class Lattice(NamedTuple):
    """Positions as whole numbers: x = low + scale · k with k from 0 to 65535 along each axis.

    low   : (xyz,) corner of the box, mesh unit
    scale : distance of neighbouring lattice points, mesh unit
    """

    low: Floats
    scale: float

    @classmethod
    def around(cls, low: Floats, high: Floats) -> "Lattice":
        """The finest lattice that covers a box.

        low, high : (xyz,) corners of the box, mesh unit
        """
        return cls(np.asarray(low, np.float64), max(float(np.max(high - low)), 1e-300) / LARGEST_LEVEL)

    def levels(self, X: Floats) -> npt.NDArray[np.uint16]:
        """The nearest lattice points, at most scale / 2 away along each axis inside the box.

        X       : (…, xyz) mesh unit
        returns : (…, xyz) whole numbers k
        """
        return np.clip(np.rint((X - self.low) / self.scale), 0, LARGEST_LEVEL).astype(np.uint16)


def evenly_spread(count: int, limit: int) -> Ints:
    """At most `limit` of the numbers from 0 to count − 1, evenly spread, including the first and the last.

    returns : (at most limit,) ascending
    """
    return np.unique(np.rint(np.linspace(0, count - 1, min(count, limit))).astype(np.int64))


def part_colouring(label: Ints, F: npt.NDArray[np.integer], colours: int) -> Ints:
    """A colour for every part, different from those of the parts it touches as long as there are enough colours.

    label   : (vertex,) part, −1 for none
    F       : (face, corner)
    colours : how many colours there are
    returns : (part,) number of a colour, parts from 0 to the highest label
    """
    parts = int(label.max(initial=-1)) + 1
    touching: nx.Graph[int] = nx.Graph()
    touching.add_nodes_from(range(parts))
    sides = label[np.concatenate([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]])]
    sides = np.unique(sides[(sides.min(axis=1) >= 0) & (sides[:, 0] != sides[:, 1])], axis=0)
    touching.add_edges_from(sides.tolist())
    colour = np.zeros(parts, np.int64)
    used = np.zeros(colours, np.int64)
    for part in range(parts):
        near = {int(colour[n]) for n in touching[part] if n < part}
        free = [c for c in range(colours) if c not in near] or list(range(colours))
        colour[part] = min(free, key=lambda c: (used[c], c))
        used[colour[part]] += 1
    return colour
