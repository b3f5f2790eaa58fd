"""Loose clothes: tubes around limbs that come after the body and fold, so that no part of them is rigid.

A garment runs from one joint, or from the middle of several, to one or several others, and is wide enough for all of them. Both
ends are cut across. It is solid: what is seen of a dressed body from outside is the outside of its clothes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from kinetree.errors import FigureError
from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.input.synth.descriptions import number, refuse_unknown, suggestion
from kinetree.tasks.numerics.input.synth.implicit import Cones

_KEYS = ("name", "from", "to", "span", "radii", "folds", "depth", "lag")


class Tubes(NamedTuple):
    """Garments in every frame.

    A, D  : (frame, garment, xyz) start and vector to the end; side : (frame, garment, xyz) unit direction in which it is narrow
    table : (frame, garment, knot) radius; flat : (frame, garment) share of the radius kept along `side`
    folds : (frame, garment, 3) number of folds around, their depth at the hem as a share of the radius, their phase
    """

    A: Floats
    D: Floats
    side: Floats
    table: Floats
    flat: Floats
    folds: Floats


@dataclass(frozen=True)
class Garment:
    """One garment.

    start, end : joints; span : shares of the way from start to end between which the garment lies
    radii      : around each limb, at even steps along the span; folds : around it; depth : of the folds at the hem, share
    lag        : seconds by which it comes after the body
    """

    name: str
    start: tuple[int, ...]
    end: tuple[int, ...]
    span: tuple[float, float]
    radii: tuple[float, ...]
    folds: int
    depth: float
    lag: float

    @classmethod
    def of(cls, where: str, row: Mapping[str, Any], names: Sequence[str]) -> Garment:
        """Check a garment written as data; raises FigureError naming the garment and what was expected."""
        where = f"{where}, garment {row.get('name')!r}"
        refuse_unknown(where, row, _KEYS)
        start, end = (_joints(where, key, row.get(key), names) for key in ("from", "to"))
        if len(start) not in (1, len(end)) or set(start) & set(end):
            raise FigureError(f"{where}: from has {len(start)} joints and to {len(end)}, expected one or as many, and others")
        low, high = (number(where, "span", s, low=-0.5, high=1.2) for s in _list(where, "span", row.get("span", [0, 1]), 2))
        if not low < high:
            raise FigureError(f"{where}: span is {[low, high]}, expected two increasing shares of the way")
        radii = tuple(number(where, "radii", r, low=0.0) for r in _list(where, "radii", row.get("radii"), None))
        folds = number(where, "folds", row.get("folds", 5), low=0.0, high=40.0)
        depth = number(where, "depth", row.get("depth", 0.05), low=-1e-9, high=0.3)
        lag = number(where, "lag", row.get("lag", 0.1), low=-1e-9, high=1.0)
        return cls(str(row.get("name")), start, end, (low, high), radii, round(folds), depth, lag)


def tubes(
    garments: Sequence[Garment], rest: Floats, X: Floats, G: Floats, earlier: Sequence[Floats], seconds: Floats, knots: int
) -> Tubes:
    """Where the garments are: their ends stay behind by at most half their radius; folds wander and deepen with time.

    rest    : (joint, xyz); X : (frame, joint, xyz); G : (frame, joint, 3, 3) world rotations
    earlier : per garment, X its lag before
    seconds : (frame,)
    """
    of_garment = [_tube(g, rest, X, G, past, seconds, knots) for g, past in zip(garments, earlier, strict=True)]
    return Tubes(*(np.stack(arrays, axis=1) for arrays in zip(*of_garment, strict=True)))


def dressed(cones: Cones, worn: Tubes, t: int) -> Cones:
    """The limbs with the garments of frame t, which meet them as they are, without a blend."""
    count = len(worn.A[t])
    steps = np.abs(np.diff(worn.table[t], axis=1)).max(axis=1) * (worn.table.shape[2] - 1) / np.linalg.norm(worn.D[t], axis=1)
    folding = worn.folds[t, :, 0] * worn.folds[t, :, 1]
    slope = float(np.max(np.sqrt(1.0 + steps**2) * (1.0 + worn.folds[t, :, 1]) + folding))
    return cones._replace(
        A=np.concatenate([cones.A, worn.A[t]]),
        D=np.concatenate([cones.D, worn.D[t]]),
        side=np.concatenate([cones.side, worn.side[t]]),
        table=np.concatenate([cones.table, worn.table[t]]),
        flat=np.concatenate([cones.flat, worn.flat[t]]),
        bow=np.concatenate([cones.bow, np.zeros((count, 3))]),
        folds=np.concatenate([cones.folds, worn.folds[t]]),
        cut=np.concatenate([cones.cut, np.ones(count, np.bool_)]),
        slope=max(cones.slope, slope),
    )


def _tube(g: Garment, rest: Floats, X: Floats, G: Floats, past: Floats, seconds: Floats, knots: int) -> tuple[Floats, ...]:
    """One garment in every frame, in the order of `Tubes`."""
    s = np.linspace(*g.span, knots)
    r = np.interp(np.linspace(0.0, 1.0, knots), np.linspace(0.0, 1.0, len(g.radii)), g.radii)
    now, then = (_ways(g, x, s[[0, -1]]) for x in (X, past))
    behind = then.mean(axis=2) - now.mean(axis=2)
    far = np.linalg.norm(behind, axis=2, keepdims=True)
    behind *= 0.5 * r[[0, -1], None] / (0.5 * r[[0, -1], None] + far) * np.array([0.3, 1.0])[:, None]
    ends = now.mean(axis=2) + behind
    D = ends[:, 1] - ends[:, 0]
    apart = _across(0.5 * (now[:, 1, -1] - now[:, 1, 0]) if len(g.end) > 1 else _sideways(rest, g, G), D)
    half = np.linalg.norm(apart, axis=1) * (len(g.end) > 1)
    side = np.cross(D, apart)
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    start = 0.5 * np.linalg.norm(now[:, 0, -1] - now[:, 0, 0], axis=1)
    table = r + start[:, None] + (half - start)[:, None] * np.linspace(0.0, 1.0, knots)
    flat = np.clip(r.mean() / table.mean(axis=1), 0.4, 1.0)
    sway = np.einsum("ti,ti->t", behind[:, 1], side) / r[-1]
    depth = g.depth * (1.0 + 0.4 * np.sin(2.0 * np.pi * (0.7 * seconds + 0.37 * g.folds)))
    phase = 4.0 * sway + 1.1 * seconds + 0.5 * g.folds
    folds = np.stack([np.full(len(X), float(g.folds)), depth, phase], axis=1)
    return ends[:, 0], D, side, table, flat, folds


def _ways(g: Garment, X: Floats, s: Floats) -> Floats:
    """(frame, 2, way, xyz) points at two shares of every way from start to end."""
    start, end = X[:, list(g.start)], X[:, list(g.end)]
    return np.asarray(start[:, None] + s[:, None, None] * (end - start)[:, None], dtype=np.float64)


def _across(x: Floats, D: Floats) -> Floats:
    """(frame, xyz) the part of x across D."""
    return np.asarray(x - np.sum(x * D, axis=1, keepdims=True) / np.sum(D * D, axis=1, keepdims=True) * D, dtype=np.float64)


def _sideways(rest: Floats, g: Garment, G: Floats) -> Floats:
    """(frame, xyz) a direction across the way from start to end at rest, turned with the start."""
    way = rest[g.end[0]] - rest[g.start[0]]
    return np.asarray(G[:, g.start[0]] @ np.cross(way, np.eye(3)[np.argmin(np.abs(way))]), dtype=np.float64)


def _joints(where: str, key: str, value: object, names: Sequence[str]) -> tuple[int, ...]:
    """Indices of the joints of a list of names."""
    listed = _list(where, key, value, None)
    for name in listed:
        if name not in names:
            raise FigureError(f"{where}: {key} {name!r} is no joint{suggestion(str(name), names)}")
    return tuple(list(names).index(name) for name in listed)


def _list(where: str, key: str, value: object, count: int | None) -> Sequence[Any]:
    """A list of `count` entries, or of any number above none."""
    if not isinstance(value, Sequence) or isinstance(value, str) or not value or len(value) != (count or len(value)):
        raise FigureError(f"{where}: {key} is {value!r}, expected a list" + (f" of {count}" if count else ""))
    return value


def outfit(joints: Sequence[Mapping[str, Any]], seed: int) -> list[dict[str, Any]]:
    """Clothes for a person, as data: a skirt or wide trousers, and wide sleeves; cut and folds are drawn from a seed.

    joints : of the person, as figures have them, with the names of the adult's
    """
    rng = np.random.default_rng([seed, 1762])
    radius = {row["name"]: [float(r) for r in row.get("radii", [row.get("radius", 0.0)])] for row in joints}
    depth, lag = float(rng.uniform(0.04, 0.1)), float(rng.uniform(0.06, 0.14))
    hanging = {"depth": round(depth, 3), "lag": round(lag, 3)}
    long = float(rng.uniform(0.55, 0.95))
    if rng.random() < 0.5:
        around = (1.35 * radius["spine"][0], 1.3 * radius["knee_l"][0], 1.35 * radius["knee_l"][0])
        rows = [_row("skirt", ["hips"], ["knee_l", "knee_r"], (0.0, long), around, 8, hanging)]
    else:
        rows = []
        for side in "lr":
            hip, knee, ankle = f"hip_{side}", f"knee_{side}", f"ankle_{side}"
            thigh, shin = radius[knee], radius[ankle]
            rows.append(_row(f"thigh_{side}", [hip], [knee], (0.15, 1.02), _wider(thigh, 1.12, 1.3), 5, hanging))
            rows.append(_row(f"shin_{side}", [knee], [ankle], (0.0, 0.85), _wider(shin, 1.32, 1.6), 5, hanging))
    for side in "lr":
        shoulder, elbow, wrist = f"shoulder_{side}", f"elbow_{side}", f"wrist_{side}"
        rows.append(_row(f"sleeve_{side}", [shoulder], [elbow], (0.1, 0.97), _wider(radius[elbow], 1.22, 1.55), 5, hanging))
        if long > 0.75:
            rows.append(_row(f"cuff_{side}", [elbow], [wrist], (0.0, 0.8), _wider(radius[wrist], 1.55, 2.0), 5, hanging))
    return rows


def _row(
    name: str,
    start: list[str],
    end: list[str],
    span: tuple[float, float],
    radii: Sequence[float],
    folds: int,
    hanging: Mapping[str, float],
) -> dict[str, Any]:
    """One garment as data."""
    rounded = {"span": [round(s, 3) for s in span], "radii": [round(r, 1) for r in radii]}
    return {"name": name, "from": start, "to": end, **rounded, "folds": folds, **hanging}


def _wider(radii: Sequence[float], first: float, last: float) -> list[float]:
    """A limb's radii, wider by a share that grows towards its end."""
    return [r * (first + (last - first) * k / (len(radii) - 1)) for k, r in enumerate(radii)]
