"""Flesh of the trunk that one limb of a pair holds and the other one does not (ours).

Limbs that are mirror images are equally thick where they hang on the trunk. Where the innermost part of one holds flesh of
chest or pelvis, its border is much wider than that of the other one, and its joint lies too far inwards.
"""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.neighbours import ring_edges, rings
from kinetree.tasks.numerics.structure.joint_partners import Limb, MirroredLimbs, RootedParts, mirrored_limbs
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs
from kinetree.tasks.numerics.structure.mirrored_slices import parts_touch


class UnlikeBordersSettings(NamedTuple):
    """When a limb holds flesh of the trunk, and how much of it.

    Chosen on people 0 to 14, 100 to 114, 215 to 239, 300 to 311, 400 to 414, and 55 to 84 and 415 to 429 at 6 frames a second,
    humans 0 to 9 and 20 to 29, recorded bodies and eighteen clips of a rigged body: of these thirteen have such flesh, mostly
    at one shoulder. See RESULTS.
    """

    wider: float = 1.25
    """Radius of the limb's innermost border in that of the other one's, at least."""
    alike: float = 1.15
    """The same where the flesh ends, at most."""
    step: float = 0.125
    """Distance between places where it may end, radii of the other limb's border. Not varied."""
    least_vertices: int = 8
    """Vertices of the flesh and of what is left of the part, at least. Not varied."""
    least_pairs: int = 2
    """Pairs of limbs of the body that are found, at least, as `MirroredJointsSettings.least_pairs`."""


class Flesh(NamedTuple):
    """Flesh of the trunk.

    part   : the innermost part of a limb, in the tree's order
    vertex : (own,) its vertices that are flesh of the trunk
    """

    part: int
    vertex: Ints


def unlike_borders(
    V: Floats, F: Ints, parts: RootedParts, pairs: LimbPairs, settings: UnlikeBordersSettings | None = None
) -> list[Flesh]:
    """The flesh of the trunk that one limb of a pair holds, by part.

    All joints of both limbs are partners, so that none has a part of the trunk that the other one lacks, and none carries
    another limb. Parts that touch are none: a limb beside the other one may hold the pelvis. The flesh ends where the border
    would be as wide as the other limb's, equally far from the limb's end all around.

    V, F  : (vertex, xyz) reference, mesh unit · (face, corner)
    pairs : limbs that are mirror images
    """
    chosen, found = settings or UnlikeBordersSettings(), dict[int, Flesh]()
    if len(pairs.tip) < chosen.least_pairs:
        return []
    edge = ring_edges(*rings(F, len(V)))
    for away, limbs in zip(pairs.distance, mirrored_limbs(F, parts, pairs), strict=False):
        both = limbs.one, limbs.other
        if not _are_partners(limbs, parts.parents) or parts_touch(F, parts.place, *(int(limb.part[-1]) for limb in both)):
            continue
        radius = [float(parts.radius[limb.part[-1]]) for limb in both]
        side = int(np.argmax(radius))
        part = int(both[side].part[-1])
        if part in found or not 0.0 < min(radius) * chosen.wider <= max(radius):
            continue
        vertex = _flesh(V, edge, parts.place, both[side], away[side], min(radius), chosen)
        if len(vertex):
            found[part] = Flesh(part, vertex)
    return [found[part] for part in sorted(found)]


def _are_partners(limbs: MirroredLimbs, parents: Ints) -> bool:
    """Whether all joints of two limbs are partners, in order, and no other limb hangs on either."""
    one, other, row = limbs
    count = len(one.part)
    is_single = all((parents == part).sum() <= 1 for limb in (one, other) for part in limb.part)
    return count > 0 and count == len(other.part) and row.tolist() == [[k, k] for k in range(count)] and is_single


def _flesh(V: Floats, edge: Ints, place: Ints, limb: Limb, away: Floats, radius: float, chosen: UnlikeBordersSettings) -> Ints:
    """(own,) the vertices that a limb's innermost part is to lose, so that its border is as wide as the other limb's; none
    where it never is.

    edge   : (edge, 2) both ways
    place  : (vertex,) part
    away   : (vertex,) from the end of the limb, mesh unit
    radius : of the other limb's border, mesh unit
    """
    part, own = int(limb.part[-1]), np.flatnonzero((place == limb.part[-1]) & np.isfinite(away))
    outwards = edge[np.isin(place[edge[:, 0]], part) & ~np.isin(place[edge[:, 1]], limb.part[:-1])]
    a, b = outwards.T
    middle = (V[a] + V[b]) / 2.0
    for level in np.arange(limb.level[-1], away[own].min(), -chosen.step * radius):
        is_left = away <= level
        on_border = is_left[a] & ((place[b] != part) | ~is_left[b])
        lost = own[~is_left[own]]
        if len(own) - len(lost) < chosen.least_vertices or not on_border.any():
            break
        spread = middle[on_border] - middle[on_border].mean(axis=0)
        if np.sqrt((spread**2).sum(axis=1).mean()) <= chosen.alike * radius:
            return lost if len(lost) >= chosen.least_vertices else lost[:0]
    return own[:0]
