"""Where a part of the trunk may be two: rings across it, at several distances from where it meets its neighbour (ours).

Where a spine turns by 20° between pelvis and chest, aligned vertices spread the turn over both, so that a cut makes one part of
them.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components, dijkstra

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.geometry.neighbours import edge_lengths, ring_edges, rings
from kinetree.tasks.numerics.structure.articulated_fit import beyond
from kinetree.tasks.numerics.structure.end_cuts import EndCut, EndCutsSettings, is_wide, ring_at


class TrunkCutsSettings(NamedTuple):
    """Which rings are proposed. Chosen on the bodies that `EndJointsSettings.least_score_in_trunk` names."""

    levels: tuple[float, ...] = (0.15, 0.29, 0.43, 0.57, 0.71, 0.85)
    """Distances from the border, shares of the greatest on the part."""
    closer_levels: tuple[float, ...] = (0.08, 0.15, 0.22, 0.29, 0.36, 0.43, 0.5, 0.57, 0.64, 0.71, 0.78, 0.85, 0.92)
    """The same where these rings have shown no joint, or one that divides the part: between rings that lie twice as far apart
    chests of humans 3 and 63 score less than they need."""
    neighbours: int = 3
    """Parts that hang on the part or that it hangs on, at least: a part of the trunk carries limbs. One that has two is of the
    trunk as well where such a part lies on either side of it, as an abdomen between pelvis and chest."""
    on_one_side: float = 0.65
    """Share of the border with every other neighbour that lies on one side of the ring, at least. Rings that part a border,
    through shoulders, score up to 0.074 where nothing turns."""
    least_piece: float = 0.03
    """Share of the part's vertices from which on a piece of its surface counts: each side of a ring must be one."""


class _Part(NamedTuple):
    """A part of the trunk.

    own    : (own,) its vertices
    edge   : (edge, 2) from one of its vertices to any other
    inside : (edge, 2) those within it
    joints : by neighbour, (xyz,) where it meets the part, mesh unit
    """

    part: int
    own: Ints
    edge: Ints
    inside: Ints
    joints: dict[int, Floats]

    def border(self, label: Ints, neighbour: int) -> Ints:
        """Its vertices beside a neighbour's."""
        return np.unique(self.edge[label[self.edge[:, 1]] == neighbour, 0])


def trunk_cuts(
    V: Floats,
    F: Ints,
    area: Floats,
    label: Ints,
    parents: Ints,
    rest: Floats,
    mirrored: Flags,
    settings: TrunkCutsSettings | None = None,
) -> Iterator[EndCut]:
    """Rings across all parts of the trunk, from the part above, of the root from each part of the trunk that hangs on it.

    V, F     : (vertex, xyz) reference, mesh unit · (face, corner)
    area     : (vertex,) mesh unit²
    label    : (vertex,) part
    parents  : (part,) −1 for the root, which is the first; a part comes after its parent
    rest     : (part, xyz) joints in the reference, mesh unit
    mirrored : (part,) whether each is of a limb with a mirror image, so that it is not of the trunk
    """
    chosen = settings or TrunkCutsSettings()
    start, ring = rings(F, len(V))
    edges = ring_edges(start, ring)
    for one in _parts(edges, label, parents, rest, mirrored, chosen):
        is_root = parents[one.part] < 0
        for above in sorted(one.joints) if is_root else [int(parents[one.part])]:
            if not mirrored[one.part] and not mirrored[above]:
                yield from _across(V, area, label, one, above, chosen)


def _parts(
    edges: Ints, label: Ints, parents: Ints, rest: Floats, mirrored: Flags, chosen: TrunkCutsSettings
) -> Iterator[_Part]:
    """The parts of the trunk, see `_are_of_trunk`."""
    for part in np.flatnonzero(_are_of_trunk(parents, mirrored, chosen.neighbours)).tolist():
        joints = {int(k): rest[k] for k in np.flatnonzero(parents == part)}
        if parents[part] >= 0:
            joints[int(parents[part])] = rest[part]
        edge = edges[label[edges[:, 0]] == part]
        if len(edge):
            yield _Part(part, np.flatnonzero(label == part), edge, edge[label[edge[:, 1]] == part], joints)


def _are_of_trunk(parents: Ints, mirrored: Flags, neighbours: int) -> Flags:
    """(part,) whether each has so many neighbours, or lies between two that have; parts of mirrored limbs do not count."""
    below = beyond(parents) > 0
    carries = np.bincount(parents[parents >= 0], minlength=len(parents)) + (parents >= 0) >= neighbours
    carries &= ~mirrored
    downwards = [(below[parents == part] & carries).any(axis=1).sum() for part in range(len(parents))]
    upwards = (~below & carries).any(axis=1)
    return carries | (np.array(downwards) + upwards > 1)


def _across(V: Floats, area: Floats, label: Ints, one: _Part, above: int, chosen: TrunkCutsSettings) -> Iterator[EndCut]:
    """Rings between a part's border with one neighbour and its other neighbours, nearest first."""
    border = one.border(label, above)
    if not len(border):
        return
    limits = EndCutsSettings()
    distance = dijkstra(edge_lengths(V, one.inside), directed=False, indices=border, min_only=True)
    distance = np.where(np.isfinite(distance), distance, 0.0)
    others = {k: _border_or_nearest(V, label, one, k) for k in one.joints if k != above}
    for level in np.array(chosen.levels) * np.quantile(distance[one.own], limits.farthest):
        cut = ring_at(V, (one.part, above), one.own, distance, one.inside, float(level))
        if cut is None or not is_wide(cut, area, limits) or not _is_in_two(cut, one, chosen):
            continue
        share_beyond = {k: float((distance[v] >= level).mean()) for k, v in others.items()}
        is_parted = any(1.0 - chosen.on_one_side < share < chosen.on_one_side for share in share_beyond.values())
        hung = tuple(k for k, share in share_beyond.items() if share >= chosen.on_one_side)
        if hung and not is_parted:
            nearest = min(float(np.linalg.norm(cut.centre - joint)) for joint in one.joints.values())
            yield cut._replace(hung=hung, apart=nearest / max(cut.radius, np.finfo(float).tiny))


def _border_or_nearest(V: Floats, label: Ints, one: _Part, neighbour: int) -> Ints:
    """The part's vertices beside a neighbour's; where they do not meet, the one nearest to their joint."""
    border = one.border(label, neighbour)
    if len(border):
        return border
    return one.own[[int(np.argmin(np.linalg.norm(V[one.own] - one.joints[neighbour], axis=1)))]]


def _is_in_two(cut: EndCut, one: _Part, chosen: TrunkCutsSettings) -> bool:
    """Whether the ring parts the part in two pieces."""
    return all(_is_one(one, cut.own[side], chosen) for side in (cut.far, ~cut.far))


def _is_one(one: _Part, side: Ints, chosen: TrunkCutsSettings) -> bool:
    """Whether vertices of a part are one piece of its surface, but for small ones."""
    place = np.full(int(one.own.max()) + 1, -1)
    place[side] = np.arange(len(side))
    edge = place[one.inside]
    edge = edge[(edge >= 0).all(axis=1)]
    graph = coo_array((np.ones(len(edge)), (edge[:, 0], edge[:, 1])), shape=(len(side), len(side)))
    pieces = np.bincount(connected_components(graph, directed=False)[1])
    return int((pieces >= chosen.least_piece * len(one.own)).sum()) == 1
