"""Necks: bones that the shape alone shows, tubes between what carries them and what they carry (ours).

A short neck turns no vertex by itself, and a round head shows no turn about its own axis. The aligned neck moves as one piece
with the head or with the trunk, so that motion shows one joint of two, at either end. The shape shows both: a last part that
hangs on a tube narrower than itself and than what carries the tube has a joint at both ends of the tube.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from scipy.sparse.csgraph import dijkstra

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.geometry.neighbours import edge_lengths
from kinetree.tasks.numerics.structure.still_joints import StillJoint


class NecksSettings(NamedTuple):
    """What makes a neck; its radius is its least girth over 2π.

    But for `near_end` and `apart` chosen on generated humans of seeds 0 to 9, quadrupeds and random trees of seeds 0 to 2, and
    not varied.
    """

    trunk: float = 2.0
    """Girth of what carries the tube, in girths of the tube, at least: trunks had 2.55 and more, forearms and shanks before
    wrists and ankles 1.49 at most."""
    head: float = 1.4
    """The same of what it carries: heads had 1.6 to 1.9, plain ends of limbs less than 1.3."""
    reach: float = 3.0
    """How far from the tube's narrowest place these girths are looked for, in its radii."""
    slack: float = 1.25
    """Girth at which the tube ends, in its least ones."""
    near: float = 1.5
    """How far from the border of the part the narrowest place is looked for, in radii of the border."""
    near_end: float = 1.3
    """Distance from an end of the tube within which a joint is that of this end, in its radii. Chosen with `apart` on people 0
    to 19, 60 to 69 and 86 to 99, humans 0 to 4 and 60 to 64, wave, dance and ballet: of 52 that have one joint at a tube it
    lies within 1.3 of one end and 0.9 or more from the other in all but one, which has 1.46 and 1.5."""
    apart: float = 0.85
    """Distance of the tube's other end from that joint, and from all others, at least."""
    step: float = 0.125
    """Distance between rings, in radii of the border."""


class _Rings(NamedTuple):
    """Rings about a border: level (ring,) signed distance from it, girth (ring,) mesh unit, centre (ring, xyz)."""

    level: Floats
    girth: Floats
    centre: Floats


def necks(
    V: Floats, F: Ints, label: Ints, parents: Ints, rest: Floats, border: Floats, settings: NecksSettings | None = None
) -> Iterator[StillJoint]:
    """The necks on which the last parts of limbs hang, by part; none where the surface has a hole, which looks like a tube.

    V, F    : (vertex, xyz) reference, mesh unit · (face, corner)
    label   : (vertex,) part
    parents : (part,) −1 for the root
    rest    : (part, xyz) joints in the reference, mesh unit
    border  : (part,) radius of the border at each joint, mesh unit
    """
    chosen, edge = settings or NecksSettings(), np.concatenate([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]])
    pairs, faces = np.unique(np.sort(edge, axis=1), axis=0, return_counts=True)
    links, rim = edge_lengths(V, pairs), pairs[faces == 1].ravel()
    for part in range(1, len(parents)):
        crossing = edge[(label[edge] == part).sum(axis=1) == 1]
        if border[part] > 0.0 and len(crossing) and not (parents == part).any():
            reach = (chosen.near + chosen.reach + 1.0) * float(border[part])
            distance = dijkstra(links, directed=False, indices=np.unique(crossing), min_only=True, limit=reach)
            half = 0.5 * np.linalg.norm(V[crossing[:, 0]] - V[crossing[:, 1]], axis=1).mean()
            beyond = np.where(label == part, 1.0, -1.0) * (distance + half)
            others = np.delete(rest, [0, part], axis=0)
            neck = _neck(V, F, beyond, part, rest[part], others, float(border[part]), chosen)
            if neck is not None and not (neck.share[rim] > 0.0).any():
                yield neck


def _neck(
    V: Floats, F: Ints, beyond: Floats, part: int, joint: Floats, others: Floats, border: float, chosen: NecksSettings
) -> StillJoint | None:
    """The neck of a part; None where there is none, or a joint at both of its ends."""
    rings = _rings(V, F, beyond, border, chosen)
    ends = _ends(rings, border, chosen)
    if ends is None:
        return None
    centre = rings.centre[ends]
    radius = float(rings.girth[ends[0] : ends[1] + 1].min() / (2.0 * np.pi))
    away = np.linalg.norm(centre - joint, axis=1) / radius
    free = int(away.argmax())
    taken = bool(len(others)) and np.linalg.norm(others - centre[free], axis=1).min() < chosen.apart * radius
    if away.min() > chosen.near_end or away.max() < chosen.apart or taken:
        return None
    low, high = rings.level[ends]
    share = np.clip(0.5 + np.minimum(beyond - low, high - beyond) / radius, 0.0, 1.0)
    return StillJoint(part, free == 0, centre[free], radius, np.where(np.isfinite(beyond), share, 0.0))


def _rings(V: Floats, F: Ints, beyond: Floats, border: float, chosen: NecksSettings) -> _Rings:
    """Rings at equal distances as far as the surface goes on both sides, without those that cross no face."""
    near = F[np.isfinite(beyond[F]).all(axis=1)]
    order = np.argsort(beyond[near], axis=1)
    corner = np.take_along_axis(near, order, axis=1)
    d, step = beyond[corner], chosen.step * border
    low = np.ceil(d[:, 0] / step).astype(np.int64)
    count = np.maximum(np.ceil(d[:, 2] / step).astype(np.int64) - low, 0)
    face = np.repeat(np.arange(len(near)), count)
    level = np.arange(len(face)) - np.repeat(np.cumsum(count) - count, count) + low[face]
    P, s, d = V[corner[face]], level * step, d[face]
    first = _crossing(P[:, 0], P[:, 2], d[:, 0], d[:, 2], s)
    lower = s < d[:, 1]
    second = np.where(
        lower[:, None], _crossing(P[:, 0], P[:, 1], d[:, 0], d[:, 1], s), _crossing(P[:, 1], P[:, 2], d[:, 1], d[:, 2], s)
    )
    length = np.linalg.norm(second - first, axis=1)
    used, row = np.unique(level, return_inverse=True)
    girth = np.maximum(np.bincount(row, length, len(used)), 1e-300)
    sums = np.stack([np.bincount(row, length * x, len(used)) for x in ((first + second) / 2.0).T], axis=1)
    return _Rings(used * step, girth, sums / girth[:, None])


def _crossing(a: Floats, b: Floats, da: Floats, db: Floats, s: Floats) -> Floats:
    """(row, xyz) where edges from a to b reach a distance s."""
    share = (s - da) / np.where(db > da, db - da, 1.0)
    return np.asarray(a + share[:, None] * (b - a))


def _ends(rings: _Rings, border: float, chosen: NecksSettings) -> Ints | None:
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
