"""Flesh of the trunk that one limb of a pair holds and the other one does not, or that both hold (ours).

Limbs that are mirror images are equally thick where they hang on the trunk. Where the innermost part of one holds flesh of
chest or pelvis, its border is much wider than that of the other one, and its joint lies too far inwards. Where both do,
their borders are alike, but much wider than those of the next joints: they lie within the trunk, which hardly narrows there.

Where the innermost parts of both touch, as those of legs do, either may hold the pelvis, and borders do not tell. But limbs are
equally long: the one whose border lies farther from its end holds flesh of the pelvis.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.geometry.neighbours import ring_edges, rings
from kinetree.tasks.numerics.structure.joint_partners import (
    PAIRED,
    Limb,
    MirroredLimbs,
    RootedParts,
    mirrored_limbs,
    parts_touch,
)
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs
from kinetree.tasks.numerics.structure.rotation_centres import borders


class WideBordersSettings(NamedTuple):
    """When a limb holds flesh of the trunk, and how much of it.

    Chosen on people 0 to 14, 100 to 114, 215 to 239, 300 to 311, 400 to 414, and 55 to 84 and 415 to 429 at 6 frames a second,
    humans 0 to 9 and 20 to 29, recorded bodies and eighteen clips of a rigged body. See RESULTS.
    """

    wider: float = 1.25
    """Radius of the limb's innermost border in that of the other one's, at least."""
    alike: float = 1.15
    """What is left of the limb may have a border that is so many times as wide as the other one's."""
    flared: float = 2.05
    """Radius of an innermost border in that of the limb's next one, at least, where both limbs hold flesh. Chosen with
    `as_flared` and `narrower` on people 0 to 14, 545 to 569 and 600 to 634, generated bodies 0 to 9 and recorded bodies, whole
    and every fourth frame: five people and the wolf have such flesh."""
    as_flared: float = 1.93
    """The same of the other limb, at least: four people have one as wide, the other 1.76 to 1.90 times, and no flesh."""
    narrower: float = 0.97
    """Such flesh ends where the border would be so many times as wide."""
    deeper: float = 0.25
    """How much farther from the limb's end the border of a part that touches the other limb's lies than that one's, in radii of
    the smaller border, at least. Chosen with `of_way` on people 0 to 14, 545 to 569 and 600 to 609, generated bodies 0 to 9 and
    recorded bodies: ten of these people, human 8, the ballet and the wolf have such a thigh, with 0.29 to 0.7."""
    of_way: float = 0.5
    """Its flesh goes back over this share of the way to where the other one's border lies. With 1 four of those joints get
    worse by 0.6 % of the height and more; with 0, where the border is only made straight, joints gain three quarters of what
    they do with 0.5."""
    places: int = 24
    """Levels at which the flesh may end, between the border and a radius from the limb's next joint. Not varied."""
    least_vertices: int = 8
    """Vertices of the flesh and of what is left of the part, at least. Not varied."""
    least_pairs: int = 2
    """Pairs of limbs of the body that are found, at least, as `MirroredJointsSettings.least_pairs`."""


class Flesh(NamedTuple):
    """Flesh of the trunk.

    part   : the innermost part of a limb, in the tree's order
    vertex : (own,) its vertices that are flesh of the part that it hangs on, ascending
    """

    part: int
    vertex: Ints


def wide_borders(
    V: Floats,
    F: Ints,
    parts: RootedParts,
    pairs: LimbPairs,
    paired: float = PAIRED,
    settings: WideBordersSettings | None = None,
) -> list[Flesh]:
    """The flesh of the trunk that limbs of a pair hold, by part: that of the limb with the wider border, or of both.

    All joints of both limbs must be partners, and no other limb may hang on either: else one of them may have a part of the
    trunk that the other one lacks.

    V, F   : (vertex, xyz) reference, mesh unit · (face, corner)
    parts  : of all vertices
    pairs  : limbs that are mirror images
    paired : radii, see `joint_partners.PAIRED`
    """
    chosen, found = settings or WideBordersSettings(), dict[int, Flesh]()
    if len(pairs.tip) < chosen.least_pairs:
        return []
    for away, limbs in zip(pairs.distance, mirrored_limbs(F, parts, pairs, paired), strict=False):
        both = limbs.one, limbs.other
        if not _are_partners(limbs, parts.parents):
            continue
        for side, vertex in _held(V, F, parts, limbs, away, chosen):
            part = int(both[side].part[-1])
            is_some = min(len(vertex), (parts.place == part).sum() - len(vertex)) >= chosen.least_vertices
            if part not in found and is_some:
                found[part] = Flesh(part, vertex)
    return [found[part] for part in sorted(found)]


def _held(
    V: Floats, F: Ints, parts: RootedParts, limbs: MirroredLimbs, away: Floats, chosen: WideBordersSettings
) -> Iterator[tuple[int, Ints]]:
    """Which of two limbs hold flesh of the trunk, and its vertices (own,).

    away : (2, vertex) from the end of each limb, mesh unit
    """
    both = limbs.one, limbs.other
    if not parts_touch(F, parts.place, *(int(limb.part[-1]) for limb in both)):
        for side, most in _too_wide(parts.radius, limbs, chosen):
            yield side, _flesh(V, F, parts, both[side], away[side], most, chosen)
        return
    level = [float(limb.level[-1]) for limb in both]
    side, least = int(np.argmax(level)), min(float(parts.radius[limb.part[-1]]) for limb in both)
    if chosen.deeper * least <= level[side] - min(level) < np.inf:
        inner = _Innermost.of(F, parts, both[side], away[side])
        yield side, np.flatnonzero(inner.beyond(level[side] - chosen.of_way * (level[side] - min(level))))


def _too_wide(radius: Floats, limbs: MirroredLimbs, chosen: WideBordersSettings) -> list[tuple[int, float]]:
    """Which of two limbs hold flesh of the trunk, and how wide the border of each may be.

    radius : (part,) of borders, mesh unit
    """
    both = limbs.one, limbs.other
    own = [float(radius[limb.part[-1]]) for limb in both]
    if min(own) * chosen.wider <= max(own):
        return [(int(np.argmax(own)), chosen.alike * min(own))]
    if len(limbs.row) < 2:
        return []
    flare = [own[side] / max(float(radius[limb.part[-2]]), np.finfo(float).tiny) for side, limb in enumerate(both)]
    if min(flare) < chosen.as_flared:
        return []
    return [(side, chosen.narrower * own[side]) for side in (0, 1) if flare[side] >= chosen.flared]


def _are_partners(limbs: MirroredLimbs, parents: Ints) -> bool:
    """Whether two limbs have joints, all of them partners in their order, and no other limb hangs on either."""
    one, other, row = limbs
    count = len(row)
    is_single = all((parents == part).sum() <= 1 for limb in (one, other) for part in limb.part)
    are_all = 0 < count == len(one.part) == len(other.part)
    return are_all and row.tolist() == [[k, k] for k in range(count)] and is_single


def _flesh(V: Floats, F: Ints, parts: RootedParts, limb: Limb, away: Floats, most: float, chosen: WideBordersSettings) -> Ints:
    """(own,) the vertices that a limb's innermost part is to lose, so that the limb's border is no wider than allowed; none
    where it always is.

    away : (vertex,) from the end of the limb, mesh unit
    most : radius of the border, mesh unit
    """
    inner, is_limb = _Innermost.of(F, parts, limb, away), np.isin(parts.place, limb.part)
    if not inner.is_own.any():
        return np.zeros(0, np.int64)
    lowest = limb.level[-2] + most if len(limb.part) > 1 else float(away[inner.is_own].min())
    for level in np.linspace(limb.level[-1], lowest, chosen.places) if lowest < limb.level[-1] else ():
        lost = inner.beyond(level)
        met = borders(V, F, (is_limb & ~lost).astype(np.int64))
        if len(met.radius) and met.radius[0] <= most:
            return np.flatnonzero(lost)
    return np.zeros(0, np.int64)


class _Innermost(NamedTuple):
    """The part of a limb that hangs on the trunk.

    is_own   : (vertex,) on this part, where a path leads to the limb's end
    is_trunk : (vertex,) on the part that it hangs on
    away     : (vertex,) from the end of the limb, mesh unit
    edge     : (edge, 2) of the reference, both ways
    """

    is_own: Flags
    is_trunk: Flags
    away: Floats
    edge: Ints

    @classmethod
    def of(cls, F: Ints, parts: RootedParts, limb: Limb, away: Floats) -> "_Innermost":
        part = int(limb.part[-1])
        is_own, is_trunk = (parts.place == part) & np.isfinite(away), parts.place == parts.parents[part]
        return cls(is_own, is_trunk, away, ring_edges(*rings(F, len(parts.place))))

    def beyond(self, level: float) -> Flags:
        """(vertex,) its own that lie farther from the limb's end and from which a path over these leads to the trunk."""
        some = self.is_own & (self.away > level)
        a, b = self.edge[(some | self.is_trunk)[self.edge].all(axis=1)].T
        piece = connected_components(coo_array((np.ones(len(a), np.bool_), (a, b)), shape=(len(some), len(some))))[1]
        return some & np.isin(piece, piece[self.is_trunk])
