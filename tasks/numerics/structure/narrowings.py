"""Joints where limbs narrow: a hand or a foot begins beyond a narrowing of forearm or shank (ours).

A forearm is round, so that aligned vertices do not show how far a hand turns about the forearm's axis, and an ankle may not
turn at all. The shape shows where both are: where the last part of a limb is clearly narrower than on either side it has a
joint. Limbs of a pair have it at the same distance from their ends.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.geometry.girths import girths
from kinetree.tasks.numerics.structure.end_cuts import share_beyond
from kinetree.tasks.numerics.structure.joint_partners import RootedParts
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs
from kinetree.tasks.numerics.structure.still_joints import StillJoint


class NarrowingsSettings(NamedTuple):
    """What makes a narrowing; its radius is its girth over 2π.

    Chosen on people 0 to 14, 100 to 114 and 215 to 229. Their wrists narrow by 1.39 to 1.57, ankles by 1.17 to 1.3. With 1.1
    and three radii from the joint no pair is false on these, on people 55 to 84 and 240 to 254, humans 0 to 9 and 20 to 29,
    four-legged bodies 0 to 14, random trees 0 to 9, recorded ones and eighteen clips of a rigged body.
    """

    least_pairs: int = 2
    """Pairs of limbs of the body that are found, at least, as `MirroredJointsSettings.least_pairs`."""
    narrow: float = 1.15
    """Girth of the widest ring on either side, in the narrowing's, at least."""
    least: float = 0.25
    """Radius of the narrowing in that of the border at the limb's own last joint, at least: where a part is cut off obliquely,
    rings shrink to nothing."""
    from_joint: float = 3.5
    """Distance from the limb's own last joint, in radii, at least: nearer by, it is that joint's."""
    from_end: tuple[float, float] = (3.0, 9.5)
    """Distance from the limb's end, in radii, at least and at most: fingers and toes have narrowings as well, and a bone as
    long as a wolf's hind foot is narrowest amid two joints. Of people it is 5.1 to 8.9; of the wolf in every fourth frame, for
    which the second was added, 10.2 and 11.2, 5 % of the height from the next joint."""
    alike: float = 1.5
    """Difference of the distances of both limbs' narrowings from their ends, in radii, at most."""
    outwards: float = 0.75
    """Distance of the joint from the narrowing, towards the end, in radii: wrists lie 0.5 beyond, ankles 1."""
    step: float = 0.02
    """Distance between rings, share of that from the limb's end to the farthest vertex of the part."""


class Narrowing(NamedTuple):
    """The ring about the last part of a limb that is narrowest against those on either side.

    level  : its distance from the limb's end, mesh unit
    place  : that of the joint beyond it
    radius : mesh unit
    joint  : (xyz,) in the reference, mesh unit
    away   : (vertex,) distance from the limb's end, mesh unit; infinite where no path leads
    """

    part: int
    level: float
    place: float
    radius: float
    joint: Floats
    away: Floats


def narrowings(
    V: Floats, F: Ints, parts: RootedParts, rest: Floats, pairs: LimbPairs, settings: NarrowingsSettings | None = None
) -> list[StillJoint]:
    """Joints beyond the narrowings of the last parts of limbs that are mirror images, by part.

    V, F  : (vertex, xyz) reference, mesh unit · (face, corner)
    rest  : (part, xyz) joints in the reference, mesh unit
    pairs : ends of limbs that are mirror images
    """
    chosen, found = settings or NarrowingsSettings(), dict[int, StillJoint]()
    for one, other in limb_narrowings(V, F, parts, rest, pairs, chosen):
        if one is None or other is None or one.part == other.part:
            continue
        if abs(one.level - other.level) <= chosen.alike * min(one.radius, other.radius):
            for narrowing in (one, other):
                beyond = np.where(np.isfinite(narrowing.away), narrowing.place - narrowing.away, -np.inf)
                joint = StillJoint(
                    narrowing.part, False, narrowing.joint, narrowing.radius, 1.0 - share_beyond(beyond, narrowing.radius)
                )
                found.setdefault(narrowing.part, joint)
    return [found[part] for part in sorted(found)]


def limb_narrowings(
    V: Floats, F: Ints, parts: RootedParts, rest: Floats, pairs: LimbPairs, settings: NarrowingsSettings | None = None
) -> Iterator[tuple[Narrowing | None, Narrowing | None]]:
    """Of both limbs of every pair; None of a limb that has none. Arguments are as in `narrowings`."""
    chosen = settings or NarrowingsSettings()
    if len(pairs.tip) >= chosen.least_pairs:
        for tips, away in zip(*pairs, strict=True):
            one, other = (
                _narrowing(V, F, parts, rest, int(parts.place[tip]), own, chosen) for tip, own in zip(tips, away, strict=True)
            )
            yield one, other


def _narrowing(
    V: Floats, F: Ints, parts: RootedParts, rest: Floats, part: int, away: Floats, chosen: NarrowingsSettings
) -> Narrowing | None:
    """That of a limb's last part; None where it has none, and where the limb has no joint or its end is not on its last part.

    away : (vertex,) distance from the limb's end, mesh unit
    """
    own = parts.place == part
    if parts.parents[part] < 0 or (parts.parents == part).any() or not np.isfinite(away[own]).any():
        return None
    rings = girths(V, F[own[F].all(axis=1)], away, chosen.step * float(away[own & np.isfinite(away)].max()))
    if len(rings.girth) < 3:
        return None
    outside, inside = np.maximum.accumulate(rings.girth), np.maximum.accumulate(rings.girth[::-1])[::-1]
    radius = rings.girth / (2.0 * np.pi)
    is_apart = np.linalg.norm(rings.centre - rest[part], axis=1) >= chosen.from_joint * radius
    low, high = chosen.from_end
    is_beyond = (rings.level >= low * radius) & (rings.level <= high * radius)
    is_free = is_apart & is_beyond & (radius >= chosen.least * parts.radius[part])
    is_least = (rings.girth <= np.append(rings.girth[1:], np.inf)) & (rings.girth <= np.append(np.inf, rings.girth[:-1]))
    narrow = np.where(is_free & is_least, np.minimum(outside, inside) / rings.girth, 0.0)
    k = int(narrow.argmax())
    if narrow[k] < chosen.narrow:
        return None
    place = rings.level[k] - chosen.outwards * radius[k]
    joint = rings.centre[np.abs(rings.level - place).argmin()]
    return Narrowing(part, float(rings.level[k]), float(place), float(radius[k]), joint, away)
