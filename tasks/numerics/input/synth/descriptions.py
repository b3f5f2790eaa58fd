"""Reading figures that a user wrote as data: every refusal says which figure, joint and key, and what was expected."""

from __future__ import annotations

import difflib
import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from kinetree.errors import FigureError

Triple = tuple[float, float, float]

_JOINT_KEYS = ("name", "parent", "position", "radius", "radii", "flatten", "side", "blend", "flesh")
_CURVE_KEYS = ("axis", "amplitude", "distance", "frequency", "phase", "offset", "keys", "slides", "period")


@dataclass(frozen=True)
class Joint:
    """One joint at rest, and the limb that leads to it from its parent.

    radii   : the limb's radius at even steps from the parent to this joint; the root's single radius is its ball's
    flatten : share of its radius that the limb keeps along `side` (rest coordinates)
    blend   : width of the blend between the limbs that meet here, as a share of the radius
    flesh   : how far the middle of the limbs lies off the joint at rest, as that of a trunk off its spine
    """

    name: str
    parent: int
    position: Triple
    radii: tuple[float, ...]
    flatten: float
    side: Triple
    blend: float
    flesh: Triple


@dataclass(frozen=True)
class Curve:
    """An angle in degrees (or, at the root, a shift in the figure's unit when `slides`) as a function of seconds.

    offset + amplitude · sin 2π(frequency·s + phase), or the smooth curve through `keys` ((second, value), …) + offset. With a
    `period` in seconds the keys repeat, and the way from one to the next is that of least jerk.
    """

    axis: Triple
    amplitude: float
    frequency: float
    phase: float
    offset: float
    keys: tuple[tuple[float, float], ...]
    slides: bool
    period: float = 0.0


Motion = Mapping[str, tuple[Curve, ...]]


def suggestion(word: str, known: Iterable[str]) -> str:
    """The end of a message about an unknown word: the nearest known one, and what there is."""
    words = sorted(known)
    nearest = difflib.get_close_matches(str(word), words, n=1, cutoff=0.5)
    return (f"; did you mean {nearest[0]!r}?" if nearest else "") + f" (known: {', '.join(words) or 'none'})"


def read_joints(where: str, entries: Sequence[Any]) -> tuple[Joint, ...]:
    """Check the joints and put parents before children, otherwise keeping the user's order."""
    waiting: dict[str, Mapping[str, Any]] = {}
    for entry in entries:
        row = mapping(where, "a joint", entry)
        refuse_unknown(f"{where}, joint {row.get('name')!r}", row, _JOINT_KEYS)
        name = str(row.get("name", ""))
        if not name or name in waiting:
            raise FigureError(f"{where}: joint name {name!r} is {'given twice' if name else 'missing'}")
        waiting[name] = row
    for name, row in waiting.items():
        parent = row.get("parent")
        if parent is not None and (not isinstance(parent, str) or parent not in waiting):
            raise FigureError(f"{where}, joint {name!r}: parent {parent!r} is no joint{suggestion(parent, waiting)}")
    roots = [name for name, row in waiting.items() if row.get("parent") is None]
    if len(roots) != 1:
        raise FigureError(f"{where}: {len(roots)} joints have no parent ({', '.join(roots)}), expected exactly one root")
    order: dict[str, int] = {}
    joints: list[Joint] = []
    while len(order) < len(waiting):
        ready = [n for n, row in waiting.items() if n not in order and (n == roots[0] or row.get("parent") in order)]
        if not ready:
            lost = ", ".join(n for n in waiting if n not in order)
            raise FigureError(f"{where}: the joints {lost} hang on each other in a circle, not on the root {roots[0]!r}")
        row = waiting[ready[0]]
        parent = row.get("parent")
        joints.append(_joint(f"{where}, joint {ready[0]!r}", row, None if parent is None else joints[order[parent]], order))
        order[ready[0]] = len(order)
    return tuple(joints)


def _joint(where: str, row: Mapping[str, Any], parent: Joint | None, order: Mapping[str, int]) -> Joint:
    """One joint; its limb runs from the parent's radius to its own when no profile is given."""
    position = triple(where, "position", row.get("position"))
    if "radii" in row:
        values = row["radii"] if isinstance(row["radii"], Sequence) else [row["radii"]]
    elif "radius" in row:
        values = [row["radius"]] if parent is None else [parent.radii[-1], row["radius"]]
    else:
        raise FigureError(f"{where}: it has neither radius nor radii")
    radii = tuple(number(where, "radius", r, low=0.0) for r in values)
    if parent is not None and len(radii) < 2:
        raise FigureError(f"{where}: radii is {list(radii)}, expected at least two, from the parent to the joint")
    if parent is not None and math.dist(position, parent.position) <= 0.0:
        raise FigureError(f"{where}: it lies at its parent {parent.name!r}; a limb needs a length")
    flatten = number(where, "flatten", row.get("flatten", 1.0), low=0.0, high=1.0)
    side = triple(where, "side", row.get("side", (0.0, 0.0, 0.0)))
    if flatten < 1.0 and parent is not None:
        along = np.cross(side, np.subtract(position, parent.position))
        if np.linalg.norm(along) <= 0.0:
            raise FigureError(f"{where}: flatten needs a side across the limb, found {list(side)}")
    blend = number(where, "blend", row.get("blend", 0.7), low=-1e-9)
    flesh = triple(where, "flesh", row.get("flesh", (0.0, 0.0, 0.0)))
    if parent is not None and math.dist(np.add(position, flesh), np.add(parent.position, parent.flesh)) <= 0.0:
        raise FigureError(f"{where}: its flesh lies where that of its parent {parent.name!r} does; a limb needs a length")
    return Joint(str(row["name"]), -1 if parent is None else order[parent.name], position, radii, flatten, side, blend, flesh)


def read_motion(where: str, curves: object, names: Sequence[str]) -> Motion:
    """Curves per joint of one motion."""
    motion: dict[str, tuple[Curve, ...]] = {}
    for joint, rows in mapping(where, "the motion", curves).items():
        if joint not in names:
            raise FigureError(f"{where}: {joint!r} is no joint{suggestion(joint, names)}")
        if not isinstance(rows, Sequence) or isinstance(rows, str):
            raise FigureError(f"{where}, joint {joint!r}: found {rows!r}, expected a list of curves")
        motion[joint] = tuple(_curve(f"{where}, joint {joint!r}", row, joint == names[0]) for row in rows)
    return motion


def _curve(where: str, entry: object, is_root: bool) -> Curve:
    """One curve: exactly one of amplitude, distance and keys says how far it goes."""
    row = mapping(where, "a curve", entry)
    refuse_unknown(where, row, _CURVE_KEYS)
    axis = triple(where, "axis", row.get("axis"))
    length = math.hypot(*axis)
    if length <= 0.0:
        raise FigureError(f"{where}: the axis is {list(axis)}, expected a direction")
    if sum(key in row for key in ("amplitude", "distance", "keys")) != 1:
        raise FigureError(f"{where}: found {sorted(row)}, expected exactly one of amplitude, distance and keys")
    slides = "distance" in row or row.get("slides", False) is True
    if slides and not is_root:
        raise FigureError(f"{where}: only the root may slide by a distance; other joints turn by an amplitude")
    pairs = row.get("keys", ())
    if not isinstance(pairs, Sequence) or not all(isinstance(pair, Sequence) and len(pair) == 2 for pair in pairs):
        raise FigureError(f"{where}: keys is {pairs!r}, expected a list of pairs of second and value")
    keys = tuple((number(where, "a key's second", s), number(where, "a key", v)) for s, v in pairs)
    if "keys" in row and (len(keys) < 2 or any(b[0] <= a[0] for a, b in itertools.pairwise(keys))):
        raise FigureError(f"{where}: keys are {list(keys)}, expected two or more with increasing seconds")
    period = number(where, "period", row["period"], low=0.0) if "period" in row else 0.0
    if period and (not keys or keys[-1][0] - keys[0][0] >= period):
        raise FigureError(f"{where}: period is {period:g}, expected keys that span less than it")
    reach, frequency, phase, offset = (
        number(where, key, row.get(key, default))
        for key, default in (
            ("distance" if "distance" in row else "amplitude", 0.0),
            ("frequency", 1.0),
            ("phase", 0.0),
            ("offset", 0.0),
        )
    )
    unit = (axis[0] / length, axis[1] / length, axis[2] / length)
    return Curve(unit, reach, frequency, phase, offset, keys, slides, period)


def refuse_unknown(where: str, row: Mapping[str, Any], known: Sequence[str]) -> None:
    for key in row:
        if key not in known:
            raise FigureError(f"{where}: unknown key {key!r}{suggestion(key, known)}")


def mapping(where: str, what: str, value: object) -> Mapping[str, Any]:
    if not isinstance(value, Mapping):
        raise FigureError(f"{where}: {what} is {value!r}, expected names with values")
    return value


def triple(where: str, what: str, value: object) -> Triple:
    if not isinstance(value, Sequence) or isinstance(value, str) or len(value) != 3:
        raise FigureError(f"{where}: {what} is {value!r}, expected three numbers")
    x, y, z = (number(where, what, component) for component in value)
    return (x, y, z)


def number(where: str, what: str, value: object, low: float = -math.inf, high: float = math.inf) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise FigureError(f"{where}: {what} is {value!r}, expected a finite number")
    if not low < value <= high:
        wanted = f"more than {low:g}" + (f" and at most {high:g}" if high < math.inf else "")
        raise FigureError(f"{where}: {what} is {value!r}, expected {wanted}")
    return float(value)
