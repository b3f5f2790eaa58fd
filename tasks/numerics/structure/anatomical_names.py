"""Names of joints after the anatomy of the body (ours).

A joint of a limb is told by its distance from the limb's end, of the trunk by its place between the legs and the arms.
Every name is a station, such as `knee`, with the side where it has one.
"""

from collections.abc import Mapping
from itertools import combinations
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags
from kinetree.tasks.numerics.structure.anatomy import Anatomy
from kinetree.tasks.numerics.structure.limb_motion import Motion
from kinetree.tasks.numerics.structure.limbs import Limb, ways

Stations = tuple[tuple[str, float, float], ...]
"""From the end of a limb inwards: name, distance from the end, and how far off a joint may lie, shares of the body's size."""

BESIDE = {"hip_base": "hip", "collar": "shoulder", "toe": "ankle", "finger": "wrist"}
"""Stations that only limbs have in which the one beside it was found too."""


class StationSettings(NamedTuple):
    """Where joints lie on people and four-legged animals: means of generated and recorded bodies, ends at the skin.

    Of people the size is the way from toes to crown, of animals the mean way from the ends of the legs to their outermost joint
    at the trunk.
    """

    leg: Stations = (
        ("toe", 0.045, 0.04), ("ankle", 0.12, 0.05), ("knee", 0.325, 0.08), ("hip", 0.54, 0.07), ("hip_base", 0.62, 0.06),
    )  # fmt: skip
    arm: Stations = (
        ("finger", 0.04, 0.03), ("wrist", 0.085, 0.05), ("elbow", 0.22, 0.07), ("shoulder", 0.375, 0.06),
        ("collar", 0.48, 0.08),
    )  # fmt: skip
    head: Stations = (("head", 0.09, 0.05), ("neck", 0.16, 0.05))
    hind: Stations = (
        ("hind_toe", 0.16, 0.1), ("hind_ankle", 0.38, 0.12), ("hind_knee", 0.7, 0.14), ("hind_hip", 1.0, 0.2),
    )  # fmt: skip
    fore: Stations = (
        ("fore_toe", 0.18, 0.1), ("fore_wrist", 0.4, 0.12), ("fore_elbow", 0.7, 0.14), ("fore_shoulder", 1.0, 0.2),
    )  # fmt: skip
    chest: float = 0.6
    """Share of the way from the hips to the shoulders from which on a single joint of the trunk is the chest's."""
    unmatched: float = 3.0
    """Cost of a joint without a station, in squared tolerances."""


class Named(NamedTuple):
    """A station, its side (l, r or none), and whether it is the end of a limb."""

    station: str
    side: str = ""

    @property
    def text(self) -> str:
        """The station with its side."""
        return f"{self.station}_{self.side}" if self.side else self.station


def anatomical_names(body: Motion, ends: Flags, found: Anatomy, settings: StationSettings | None = None) -> list[Named | None]:
    """The station and side of every joint; None for those that no station fits  (ours).

    ends : (joint,) whether it is the end of a bone
    """
    s = settings or StationSettings()
    names: list[Named | None] = [None] * len(body.parents)
    is_human = found.topology == "human"
    tables = ((s.leg, "foot"), (s.arm, "hand")) if is_human else ((s.hind, "hind_foot"), (s.fore, "fore_foot"))
    size = _size(body, found)
    for (stations, end), pair in zip(tables, found.pairs, strict=True):
        for side, limb in zip("lr", pair, strict=True):
            _name(names, limb, ends, _by_distance(body, limb, ends, stations, size, s), end, side)
    if (head := found.head) is not None:
        fitting = _by_distance(body, head, ends, s.head, size, s) if is_human else _in_order(head, ends, "neck", "head")
        _name(names, head, ends, fitting, "head")
    if found.tail is not None:
        tail = [f"tail_{n + 1}" for n in range(len(found.tail.joints))]
        _name(names, found.tail, ends, _in_order(found.tail, ends, *tail), "tail")
    _trunk(names, body, found, ends, s)
    _others(names, body, ends)
    return names


def _name(names: list[Named | None], limb: Limb, ends: Flags, stations: Mapping[int, str], end: str, side: str = "") -> None:
    """Enters the stations of a limb's joints, and its end."""
    for j, station in stations.items():
        names[j] = Named(station, side)
    if ends[limb.joints[0]]:
        names[limb.joints[0]] = Named(f"{end}_end", side)


def _size(body: Motion, found: Anatomy) -> float:
    """What distances along limbs are shares of."""
    legs, arms = found.pairs
    if found.topology == "quadruped":
        return float(np.mean([_from_tip(body, limb)[-1] for limb in (*legs, *arms)]))
    top = found.head.joints[0] if found.head is not None else None
    if top is None:
        return float(np.mean([limb.length for limb in legs])) / 0.6
    return float(np.mean([ways(body.rest, body.parents, top)[leg.joints[0]] for leg in legs])) / 1.05


def _from_tip(body: Motion, limb: Limb) -> list[float]:
    """Way from the limb's end to each of its joints, mesh unit."""
    way = ways(body.rest, body.parents, limb.joints[0])
    return [float(way[j]) for j in limb.joints]


def _inner(limb: Limb, ends: Flags) -> list[int]:
    """The joints of a limb that turn, from its end inwards."""
    return [j for j in limb.joints if not ends[j] and j != 0]


def _by_distance(
    body: Motion, limb: Limb, ends: Flags, stations: Stations, size: float, s: StationSettings
) -> Mapping[int, str]:
    """The stations that fit the joints of a limb best, both in their order; a joint may have none."""
    way = dict(zip(limb.joints, _from_tip(body, limb), strict=True))
    inner = _inner(limb, ends)
    best, chosen = np.inf, dict[int, str]()
    for count in range(min(len(inner), len(stations)) + 1):
        for joints in combinations(inner, count):
            for places in combinations(stations, count):
                if any(BESIDE.get(name, name) not in [other for other, _, _ in places] for name, _, _ in places):
                    continue
                pairs = list(zip(joints, places, strict=True))
                off = sum(((way[j] / size - at) / tolerance) ** 2 for j, (_, at, tolerance) in pairs)
                cost = s.unmatched * (len(inner) - count) + off
                if cost < best:
                    best, chosen = cost, {j: name for j, (name, _, _) in pairs}
    return chosen


def _in_order(limb: Limb, ends: Flags, *outwards: str) -> Mapping[int, str]:
    """The stations of a limb's joints from its base outwards."""
    return dict(zip(reversed(_inner(limb, ends)), outwards, strict=False))


def _trunk(names: list[Named | None], body: Motion, found: Anatomy, ends: Flags, s: StationSettings) -> None:
    """Names the root and the joints between the legs and the arms."""
    legs, arms = found.pairs
    low = np.mean([body.rest[leg.joints[-1]] for leg in legs], axis=0)
    axis = np.mean([body.rest[arm.joints[-1]] for arm in arms], axis=0) - low
    place = (body.rest - low) @ axis / max(float(axis @ axis), 1e-12)
    limb_joints = {j for limb in (*legs, *arms, found.head, found.tail) if limb is not None for j in limb.joints}
    between = [j for j in _path(body, legs[0].base, arms[0].base) if j != 0 and not ends[j] and j not in limb_joints]
    between.sort(key=lambda j: place[j])
    if len(between) == 1:
        names[between[0]] = Named("chest" if place[between[0]] >= s.chest else "spine")
    elif between:
        spine = between[:-1]
        for n, j in enumerate(spine):
            names[j] = Named("spine" if len(spine) == 1 else f"spine_{n + 1}")
        names[between[-1]] = Named("chest")
    if names[0] is None:
        names[0] = Named("pelvis" if 0 in (legs[0].base, legs[1].base) or not between else "torso")


def _path(body: Motion, a: int, b: int) -> list[int]:
    """The joints from one to another along the bones, both included."""
    way_a, way_b = ways(body.rest, body.parents, a), ways(body.rest, body.parents, b)
    on = np.isclose(way_a + way_b, way_a[b], rtol=1e-9, atol=1e-9 * max(float(way_a.max()), 1e-300))
    return [int(j) for j in np.argsort(way_a, kind="stable") if on[j]]


def _others(names: list[Named | None], body: Motion, ends: Flags) -> None:
    """Names all else on a limb after the joint on which it hangs, and numbers equal names."""
    for j, p in enumerate(body.parents.tolist()):
        above = names[p] if p >= 0 else None
        if names[j] is None and above is not None and p != 0:
            names[j] = Named(f"{above.station}_{'end' if ends[j] else 'part'}", above.side)
    seen: dict[Named, int] = {}
    for j, name in enumerate(names):
        if name is not None:
            seen[name] = seen.get(name, 0) + 1
            if seen[name] > 1:
                names[j] = Named(f"{name.station}_{seen[name]}", name.side)
