"""Necks: bones that the shape alone shows, tubes between what carries them and what they carry (ours).

A short neck turns no vertex by itself, and a round head shows no turn about its own axis. The aligned neck moves as one piece
with the head or with the trunk, so that motion shows one joint of two. The shape shows both: a last part that hangs on a tube
narrower than itself and than what carries the tube turns on the tube, and the tube on what carries it. The tube turns about the
lower end of where it is narrow. What it carries turns about a place beyond the upper end: a skull turns about its base, level
with the ears, and chin and nape lie lower.
"""

from collections.abc import Collection, Iterable, Iterator
from typing import NamedTuple

import numpy as np
from scipy.sparse.csgraph import dijkstra

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.geometry.girths import Girths, girths
from kinetree.tasks.numerics.geometry.neighbours import edge_lengths
from kinetree.tasks.numerics.structure.still_joints import StillJoint


class NecksSettings(NamedTuple):
    """What makes a neck; its radius is its least girth over 2π. Chosen on generated people, but where something else is said.

    `head`, `reach`, `slack`, `near` and `step` were chosen on generated humans of seeds 0 to 9 and not varied.
    """

    trunk: float = 1.75
    """Girth of what carries the tube, in girths of the tube, at least: trunks had 1.95 and more, forearms and shanks before
    wrists and ankles 1.49 at most."""
    head: float = 1.4
    """The same of what it carries: heads had 1.6 to 1.9, plain ends of limbs less than 1.3."""
    reach: float = 3.0
    """How far from the tube's narrowest place these girths are looked for, in its radii."""
    slack: float = 1.25
    """Girth at which the tube ends, in its least ones."""
    narrow: float = 1.1
    """Girth up to which it is narrow, in its least ones. With 1.05 to 1.15 joints lie as evenly from its ends."""
    base: float = 1.15
    """Distance of the upper joint from the last narrow ring, in radii of the tube, along the line through the middles of the
    narrow rings. Chosen on people 0 to 19: the true ones lie 1.15 beyond with a standard deviation of 0.33 and 0.16 beside the
    line, the lower ones 0.03 above the first narrow ring (0.38, and 0.06 beside the line)."""
    oblique: float = 0.7
    """Cosine of that line with the one through the ends of the tube, at least; below it the latter counts. Not varied."""
    near: float = 1.5
    """How far from the border of the part the narrowest place is looked for, in radii of the border."""
    near_place: float = 1.3
    """Distance of a joint from one of the tube's joints within which it is that one, in radii of the tube. Of 60 people and 16
    clips of a recorded body the farthest lies 1.25 off. Chosen on ends of tubes, when joints were expected there."""
    apart: float = 0.85
    """Distance from a place within which a joint of another part has it, and of the other place from the part's own joint, at
    least. Chosen as `near_place`."""
    astray: tuple[float, float] = (0.4, 0.8)
    """Distance of a joint from its place, in radii of the tube: up to the first it stays, from the second it is moved there.
    Chosen on people 0 to 19 and eight clips of a recorded body, where joints that stand for two lie 0.7 to 1.2 off."""
    amid: float = 0.76
    """Distance of a joint from both places, in radii, from which on it is a third one where another part has the lower one:
    some necks have two bones. Of eleven joints beside such a one, of people 0 to 19 and 60 to 69 and humans 0 and 1, the
    farthest lies 0.5 from the upper place, one of person 802 0.71; of recorded ballet the middle one lies 0.8 from it."""
    step: float = 0.125
    """Distance between rings, in radii of the border."""


class Tube(NamedTuple):
    """A narrow tube on which the last part of a limb hangs.

    part   : that hangs on it
    joint  : (2, xyz) the places where the tube turns and where the part does, in the reference, mesh unit
    radius : its least girth over 2π, mesh unit
    share  : (vertex,) how much each vertex follows the tube, 0 to 1; chin and nape follow the part
    """

    part: int
    joint: Floats
    radius: float
    share: Floats


def tubes(V: Floats, F: Ints, label: Ints, parents: Ints, border: Floats, settings: NecksSettings | None = None) -> list[Tube]:
    """The tubes on which the last parts of limbs hang, by part; none where the surface has a hole, which looks like a tube.

    V, F    : (vertex, xyz) reference, mesh unit · (face, corner)
    label   : (vertex,) part
    parents : (part,) −1 for the root
    border  : (part,) radius of the border at each joint, mesh unit
    """
    chosen, edge = settings or NecksSettings(), np.concatenate([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]])
    pairs, faces = np.unique(np.sort(edge, axis=1), axis=0, return_counts=True)
    links, rim = edge_lengths(V, pairs), pairs[faces == 1].ravel()
    found = []
    for part in range(1, len(parents)):
        crossing = edge[(label[edge] == part).sum(axis=1) == 1]
        if border[part] > 0.0 and len(crossing) and not (parents == part).any():
            reach = (chosen.near + chosen.reach + 1.0) * float(border[part])
            distance = dijkstra(links, directed=False, indices=np.unique(crossing), min_only=True, limit=reach)
            half = 0.5 * np.linalg.norm(V[crossing[:, 0]] - V[crossing[:, 1]], axis=1).mean()
            beyond = np.where(label == part, 1.0, -1.0) * (distance + half)
            tube = _tube(V, F, beyond, part, float(border[part]), chosen)
            if tube is not None and not (tube.share[rim] > 0.0).any():
                found.append(tube)
    return found


def necks(
    hanging: Iterable[Tube], rest: Floats, shown: Collection[int] = (), settings: NecksSettings | None = None
) -> Iterator[StillJoint]:
    """The joints of tubes that motion does not show, by part: the other one of two, and the upper one of three.

    hanging : tubes with the last parts of limbs on them
    rest    : (part, xyz) joints in the reference, mesh unit
    shown   : parts that the frames' surfaces alone show, see `extended_tree`; they have no joint more
    """
    chosen = settings or NecksSettings()
    for tube in hanging:
        at = _place(tube, rest, shown, chosen)
        if at is not None and tube.part not in shown:
            free = at.own if at.is_third else 1 - at.own
            if at.is_third or (not at.has_lower and at.away[free] >= chosen.apart):
                yield StillJoint(tube.part, free == 0, tube.joint[free], tube.radius, tube.share)


def on_tubes(
    hanging: Iterable[Tube], rest: Floats, shown: Collection[int] = (), settings: NecksSettings | None = None
) -> tuple[Floats, Flags]:
    """(part, xyz) joints of parts that hang on tubes, moved to their place on the tube where they are far from it; the array
    that was given where none is · (part,) joints that have such a place, where they stay.

    Where motion shows one joint of two, it lies somewhere between them. The parameters are those of `necks`.
    """
    chosen, moved, stays = settings or NecksSettings(), rest.copy(), np.zeros(len(rest), np.bool_)
    for tube in hanging:
        at = _place(tube, rest, shown, chosen)
        if at is not None:
            low, high = chosen.astray
            part, share = tube.part, 0.0 if at.is_third else float(np.clip((at.away[at.own] - low) / (high - low), 0.0, 1.0))
            moved[part] += share * (tube.joint[at.own] - rest[part])
            stays[part] = True
    return moved if (moved != rest).any() else rest, stays


class _Place(NamedTuple):
    """Where the joint of a part is on its tube.

    away      : (2,) distance from the tube's joints, in its radii
    own       : which of these it is, 0 or 1; of a third one the upper, which is still free
    has_lower : whether another part has the lower one
    is_third  : whether it is a third one, between both
    """

    away: Floats
    own: int
    has_lower: bool
    is_third: bool


def _place(tube: Tube, rest: Floats, shown: Collection[int], chosen: NecksSettings) -> _Place | None:
    """None where the joint of the part is at neither free place, or another part has the upper one."""
    joint, others = rest[tube.part], np.delete(rest, [0, tube.part], axis=0)
    low, high = tube.joint
    away = np.linalg.norm(tube.joint - joint, axis=1) / tube.radius
    length = float(np.linalg.norm(high - low))
    along = (high - low) / max(length, np.finfo(float).tiny)
    height = np.clip((others - low) @ along, 0.0, length)
    on_it = int((np.linalg.norm(others - low - np.outer(height, along), axis=1) < chosen.apart * tube.radius).sum())
    taken = [bool((np.linalg.norm(others - place, axis=1) < chosen.apart * tube.radius).any()) for place in tube.joint]
    if taken[1]:
        return None
    inside = min(float((joint - low) @ along), float((high - joint) @ along)) / tube.radius
    is_third = taken[0] and on_it == 1 and inside >= chosen.amid and tube.part not in shown
    own = 1 if taken[0] else int(away.argmin())
    if not is_third and away[own] > chosen.near_place:
        return None
    return _Place(away, own, taken[0], is_third)


def _tube(V: Floats, F: Ints, beyond: Floats, part: int, border: float, chosen: NecksSettings) -> Tube | None:
    """The tube of a part; None where there is none."""
    rings = girths(V, F, beyond, chosen.step * border)
    ends = _ends(rings, border, chosen)
    if ends is None:
        return None
    inner = slice(ends[0], ends[1] + 1)
    least = float(rings.girth[inner].min())
    radius = least / (2.0 * np.pi)
    joint = _places(rings.centre[inner], rings.girth[inner] <= chosen.narrow * least, chosen.base * radius, chosen.oblique)
    low, high = rings.level[ends]
    share = np.clip(0.5 + np.minimum(beyond - low, high - beyond) / radius, 0.0, 1.0)
    return Tube(part, joint, radius, np.where(np.isfinite(beyond), share, 0.0))


def _places(middle: Floats, is_narrow: Flags, base: float, oblique: float) -> Floats:
    """(2, xyz) the joints of a tube, the lower one first, on the line nearest to the middles of its narrow rings.

    middle    : (ring, xyz) of all rings of the tube, from its lower end to its upper one
    is_narrow : (ring,)
    base      : distance of the upper joint from the last narrow ring, mesh unit
    oblique   : see `NecksSettings`
    """
    narrow = middle[is_narrow]
    mean = narrow.mean(axis=0)
    axis = middle[-1] - middle[0]
    axis = axis / max(float(np.linalg.norm(axis)), np.finfo(float).tiny)
    if len(narrow) > 2:
        along = np.linalg.svd(narrow - mean, full_matrices=False)[2][0]
        if abs(float(along @ axis)) >= oblique:
            axis = along if along @ axis > 0.0 else -along
    low, high = (narrow[[0, -1]] - mean) @ axis
    return np.asarray(mean + np.outer([low, high + base], axis))


def _ends(rings: Girths, border: float, chosen: NecksSettings) -> Ints | None:
    """(2,) rings at which the tube ends, towards the part above and beyond; None where it is no neck."""
    level, girth = rings.level, rings.girth
    middle = np.flatnonzero(np.abs(level) <= chosen.near * border)
    if not len(middle):
        return None
    narrow = int(middle[girth[middle].argmin()])
    least, away = girth[narrow], level - level[narrow]
    within = np.abs(away) <= chosen.reach * least / (2.0 * np.pi)
    wide = girth > chosen.slack * least
    sides: list[Flags] = [within & wide & (away < 0.0), within & wide & (away > 0.0)]
    if not all(side.any() for side in sides):
        return None
    if girth[sides[0]].max() < chosen.trunk * least or girth[sides[1]].max() < chosen.head * least:
        return None
    return np.array([np.flatnonzero(sides[0])[-1], np.flatnonzero(sides[1])[0]])
