"""A moving body small enough for a page: fewer vertices, fewer frames, positions as 16-bit numbers."""

from typing import NamedTuple

import networkx as nx
import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

LEVELS = 65535


class Lattice(NamedTuple):
    """Positions as whole numbers: x = low + scale · k with k from 0 to 65535 along each axis."""

    low: Floats
    scale: float

    @classmethod
    def around(cls, low: Floats, high: Floats) -> "Lattice":
        """The finest lattice that covers a box."""
        return cls(np.asarray(low, np.float64), max(float(np.max(high - low)), 1e-300) / LEVELS)

    def levels(self, X: Floats) -> npt.NDArray[np.uint16]:
        """(…, xyz) → (…, xyz) nearest lattice points; off by at most half a scale inside the box."""
        return np.clip(np.rint((X - self.low) / self.scale), 0, LEVELS).astype(np.uint16)


def spread(count: int, limit: int) -> Ints:
    """At most `limit` of so many positions, evenly spread, the first and the last among them."""
    return np.unique(np.rint(np.linspace(0, count - 1, min(count, limit))).astype(np.int64))


def shades(label: Ints, F: npt.NDArray[np.integer], colours: int) -> Ints:
    """A colour for every part, other than those of the parts it touches while there are colours left.

    label   : (vertex,) part, −1 for none
    F       : (face, corner)
    returns : (part,) from 0 up to the highest label
    """
    parts = int(label.max(initial=-1)) + 1
    touching: nx.Graph[int] = nx.Graph()
    touching.add_nodes_from(range(parts))
    sides = label[np.concatenate([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]])]
    sides = np.unique(sides[(sides.min(axis=1) >= 0) & (sides[:, 0] != sides[:, 1])], axis=0)
    touching.add_edges_from(sides.tolist())
    out = np.zeros(parts, np.int64)
    used = np.zeros(colours, np.int64)
    for part in range(parts):
        near = {int(out[n]) for n in touching[part] if n < part}
        free = [c for c in range(colours) if c not in near] or list(range(colours))
        out[part] = min(free, key=lambda c: (used[c], c))
        used[out[part]] += 1
    return out
