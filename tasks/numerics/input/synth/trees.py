"""Random figures: a trunk, limbs in well spread directions, and curves that keep the limbs apart."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.input.synth.clearance import clearance
from kinetree.tasks.numerics.input.synth.figures import Figure
from kinetree.tasks.numerics.input.synth.flesh import Flesh
from kinetree.tasks.numerics.input.synth.motion import forward_kinematics, joint_rotations


class TreeSettings(NamedTuple):
    """What a draft must keep to."""

    seconds: float = 4.0
    """Time in which limbs are kept apart, seconds."""
    times: int = 61
    """Moments of that time that are looked at."""
    gap: float = 0.035
    """Least gap between limbs, share of the height: more than a voxel from about 2,000 vertices on."""
    least_amplitude: float = 11.0
    """Degrees to which a calmed swing keeps: twice that is more than the 15° from which a joint is scored."""
    calming: tuple[float, ...] = (1.0, 0.8, 0.64, 0.5, 0.4)
    """Shares of the amplitudes that are tried before a draft is thrown away."""
    drafts: int = 12
    """Drafts after which there is one limb less."""


_SETTINGS = TreeSettings()
_SECONDS = np.linspace(0.0, _SETTINGS.seconds, _SETTINGS.times)


def random_tree(seed: int) -> Figure:
    """A figure drawn from a seed: trunk of one to three bones, three to six limbs of one to three bones and an end.

    Every joint but the root turns. Drafts whose limbs come close to each other within four seconds are calmed, then
    thrown away; later drafts have fewer limbs, so that there is always one that passes.
    """
    rng = np.random.default_rng([seed, 77])
    limbs = int(rng.integers(3, 7))
    draft = 0
    while True:
        description = _draft(rng, max(2, limbs - draft // _SETTINGS.drafts), f"tree-{seed}")
        if _keeps_apart(Figure.of(description), np.zeros(0)):
            for calm in _SETTINGS.calming:
                figure = Figure.of(_calmed(description, calm))
                if _keeps_apart(figure, _SECONDS):
                    return figure
        draft += 1


def _draft(rng: np.random.Generator, limbs: int, name: str) -> dict[str, Any]:
    """Joints and curves of one draft, in a random unit of length."""
    scale = float(10.0 ** rng.uniform(-1.0, 3.0))
    trunk = int(rng.integers(1, 4))
    joints: list[dict[str, Any]] = []
    curves: dict[str, Any] = {}
    thick = float(rng.uniform(0.11, 0.16))
    place, heading = np.zeros(3), _direction(rng)
    spots = [place]
    joints.append({"name": "trunk_0", "position": _list(place * scale), "radius": thick * scale})
    for k in range(1, trunk + 1):
        heading = _unit(heading + 0.35 * _direction(rng))
        place = place + float(rng.uniform(0.3, 0.45)) * heading
        spots.append(place)
        joint = {"name": f"trunk_{k}", "parent": f"trunk_{k - 1}", "position": _list(place * scale), "radius": thick * scale}
        joints.append(joint)
        if k < trunk:
            curves[f"trunk_{k}"] = [_curve(rng, heading, 9.0, 14.0)]
    directions = [(k, _unit(spots[n] - spots[k])) for k in range(trunk + 1) for n in (k - 1, k + 1) if 0 <= n <= trunk]
    for limb in range(limbs):
        spot = limb % (trunk + 1) if limb < trunk + 1 else int(rng.integers(0, trunk + 1))
        out = _spread(rng, spot, directions)
        directions.append((spot, out))
        _grow(rng, joints, curves, limb, spot, spots[spot], out, thick, scale)
    return {"name": name, "unit": "unknown", "fps": 25, "joints": joints, "motions": {"sway": curves}}


def _grow(
    rng: np.random.Generator,
    joints: list[dict[str, Any]],
    curves: dict[str, Any],
    limb: int,
    spot: int,
    place: Floats,
    out: Floats,
    thick: float,
    scale: float,
) -> None:
    """Append one limb: a socket near the trunk's skin, its joints, its end, and their curves."""
    bones = int(rng.integers(1, 4))
    length = float(rng.uniform(0.28, 0.4) if bones > 1 else rng.uniform(0.4, 0.55))
    r = float(rng.uniform(0.055, 0.08))
    place = place + 0.9 * thick * out
    parent = f"limb_{limb}_0"
    start = {"name": parent, "parent": f"trunk_{spot}", "position": _list(place * scale)}
    joints.append({**start, "radii": [0.8 * thick * scale, r * scale]})
    heading = out
    for k in range(1, bones + 1):
        curves[parent] = [_curve(rng, heading, 16.0, 32.0)]
        heading = _unit(out + 0.45 * _direction(rng))
        place = place + length * float(rng.uniform(0.85, 1.15)) * heading
        taper = 1.0 - 0.42 * k / bones
        name = f"limb_{limb}_{k}" if k < bones else f"limb_{limb}_end"
        joints.append({"name": name, "parent": parent, "position": _list(place * scale), "radius": r * taper * scale})
        parent = name


def _spread(rng: np.random.Generator, spot: int, directions: list[tuple[int, Floats]]) -> Floats:
    """The direction, of many random ones, that is farthest from those taken; those at the same joint count most."""
    candidates = [_direction(rng) for _ in range(40)]
    return min(candidates, key=lambda d: max(float(d @ other) - 0.35 * (at != spot) for at, other in directions))


def _curve(rng: np.random.Generator, along: Floats, least: float, most: float) -> dict[str, Any]:
    """A swing about a random axis across the bone."""
    axis = _unit(np.cross(along, _direction(rng)))
    return {
        "axis": _list(axis),
        "amplitude": float(rng.uniform(least, most)),
        "frequency": float(rng.uniform(0.7, 1.1)),
        "phase": float(rng.uniform(0.0, 1.0)),
    }


def _calmed(description: dict[str, Any], share: float) -> dict[str, Any]:
    """The draft with every amplitude reduced to a share of it, but never so far that the joint is not scored."""
    (name, curves), *_ = description["motions"].items()
    calmer = {
        joint: [
            {**row, "amplitude": max(share * row["amplitude"], min(row["amplitude"], _SETTINGS.least_amplitude))}
            for row in rows
        ]
        for joint, rows in curves.items()
    }
    return {**description, "motions": {name: calmer}}


def _keeps_apart(figure: Figure, seconds: Floats) -> bool:
    """Whether the limbs stay apart at rest and at the given times."""
    R, shift = joint_rotations(figure, figure.motion(None), seconds)
    X, _ = forward_kinematics(figure.rest, figure.parents, R, shift)
    return bool(
        clearance(figure, Flesh.of(figure), np.concatenate([figure.rest[None], X])).min() > _SETTINGS.gap * figure.height
    )


def _direction(rng: np.random.Generator) -> Floats:
    return _unit(rng.normal(size=3))


def _unit(x: Floats) -> Floats:
    return np.asarray(x / np.linalg.norm(x), dtype=np.float64)


def _list(x: Floats) -> list[float]:
    return [float(c) for c in x]
