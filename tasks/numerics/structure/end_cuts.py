"""Where the last part of a limb may have one more joint: rings across it, at several distances from its border (ours).

A toe or a hand that is cut off too far up moves as one piece with what lies above it, because an alignment smears small turns.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.geometry.neighbours import ring_edges, rings
from kinetree.tasks.numerics.structure.end_effectors import from_border


class EndCutsSettings(NamedTuple):
    """Which rings are proposed. Chosen, with `EndJointsSettings`, on eleven bodies, see there."""

    levels: tuple[float, ...] = (0.12, 0.25, 0.38, 0.5, 0.62, 0.75)
    """Distances from the border, shares of the greatest on the part."""
    farthest: float = 0.995
    """Share of the part's vertices that are no farther than what counts as the greatest distance."""
    least_area: float = 0.0015
    """Surface on either side of a ring, share of the body's, at least."""
    least_vertices: int = 25
    """Vertices on either side of a ring, at least: a few more than a rigid piece has freedoms make hands and paws turn."""
    apart: float = 1.0
    """Distance of a ring's centre from the joint that is there, in radii of the ring, at least: nearer by, both are one."""


class EndCut(NamedTuple):
    """A ring across a part.

    part   : in the tree's order
    above  : the part that hangs together with the piece before the ring: that above; of the root, and of rings across limbs
             that the part holds, one below
    centre : (xyz,) of the ring in the reference, mesh unit
    radius : of the ring, mesh unit
    own    : (own,) vertices of the part
    beyond : (own,) how far each lies beyond the ring along the surface, negative before it, mesh unit
    hung   : parts that hang on the piece beyond the ring; none at the end of a limb
    apart  : distance of the ring from the nearest of the part's joints, in radii of the ring; not of rings at ends
    level  : which of the part's levels a ring across one of two limbs lies at, see `limb_cuts`; −1 of all other rings
    """

    part: int
    above: int
    centre: Floats
    radius: float
    own: Ints
    beyond: Floats
    hung: tuple[int, ...] = ()
    apart: float = np.inf
    level: int = -1

    @property
    def is_across_limb(self) -> bool:
        """Whether it lies across one of two limbs that the part holds, see `limb_cuts`."""
        return self.level >= 0

    @property
    def far(self) -> Flags:
        """(own,) whether each vertex lies beyond the ring."""
        return np.asarray(self.beyond >= 0.0)

    @property
    def share(self) -> Floats:
        """(own,) of each vertex that the piece beyond carries: skin blends over half a radius on either side of the ring."""
        return share_beyond(self.beyond, self.radius)


def share_beyond(beyond: Floats, radius: float) -> Floats:
    """(vertex,) how much each vertex follows the piece beyond a ring; beyond (vertex,) how far it lies beyond, mesh unit."""
    s = np.clip(0.5 + beyond / radius, 0.0, 1.0)
    return np.asarray(s * s * (3.0 - 2.0 * s))


def end_cuts(
    V: Floats, F: Ints, area: Floats, label: Ints, parents: Ints, rest: Floats, settings: EndCutsSettings | None = None
) -> Iterator[EndCut]:
    """Rings across all parts with no part below them but the root, part by part, nearest to the border first.

    V, F    : (vertex, xyz) reference, mesh unit · (face, corner)
    area    : (vertex,) mesh unit²
    label   : (vertex,) part
    parents : (part,) −1 for the root
    rest    : (part, xyz) joints in the reference, mesh unit
    """
    chosen = settings or EndCutsSettings()
    start, ring = rings(F, len(V))
    edge = ring_edges(start, ring)
    for part in range(1, len(parents)):
        own = np.flatnonzero(label == part)
        if (parents == part).any() or len(own) < 2 * chosen.least_vertices:
            continue
        distance = from_border(V, edge, label, part)
        inside = edge[(label[edge] == part).all(axis=1)]
        for level in np.array(chosen.levels) * np.quantile(distance[own], chosen.farthest):
            cut = ring_at(V, (part, int(parents[part])), own, distance, inside, float(level))
            if cut is not None and is_wide(cut, area, chosen) and _is_apart(cut, rest[part], chosen):
                yield cut


def ring_at(V: Floats, parts: tuple[int, int], own: Ints, distance: Floats, inside: Ints, level: float) -> EndCut | None:
    """The ring at one distance from where a part meets another; None where no edge crosses it.

    parts    : the part and the other one
    own      : (own,) its vertices
    distance : (vertex,) mesh unit
    inside   : (edge, 2) its edges
    """
    a, b = inside[(distance[inside[:, 0]] < level) & (distance[inside[:, 1]] >= level)].T
    if not len(a):
        return None
    middle = (V[a] + V[b]) / 2
    centre = middle.mean(axis=0)
    radius = max(float(np.sqrt(((middle - centre) ** 2).sum(axis=1).mean())), float(np.finfo(float).tiny))
    return EndCut(*parts, centre, radius, own, distance[own] - level)


def is_wide(cut: EndCut, area: Floats, chosen: EndCutsSettings) -> bool:
    """Whether there is enough surface on both sides."""
    sides = [cut.own[cut.far], cut.own[~cut.far]]
    return all(len(v) >= chosen.least_vertices and area[v].sum() >= chosen.least_area * area.sum() for v in sides)


def _is_apart(cut: EndCut, joint: Floats, chosen: EndCutsSettings) -> bool:
    """Whether the ring is not where the part's joint already lies."""
    return bool(np.linalg.norm(cut.centre - joint) >= chosen.apart * cut.radius)
