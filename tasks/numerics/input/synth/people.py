"""People drawn from a seed: other proportions than the figure they are made from, unequal sides, and motions of their own.

Sizes, shares and thicknesses vary as far as grown people and children do (ranges after the ANSUR surveys, rounded); they are
drawn from the seed alone, so that no seed was chosen for its result. Every motion is the given one with other extents, timing
and tempo, a start at any moment, and slow small movements of every joint on top of it.
"""

from __future__ import annotations

import copy
import zlib
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np

from kinetree.errors import FigureError
from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.input.synth.clearance import clearance
from kinetree.tasks.numerics.input.synth.clothes import outfit
from kinetree.tasks.numerics.input.synth.descriptions import suggestion
from kinetree.tasks.numerics.input.synth.figures import Figure
from kinetree.tasks.numerics.input.synth.flesh import Flesh
from kinetree.tasks.numerics.input.synth.motion import forward_kinematics, joint_rotations

_TRUNK = {"hips", "spine", "chest"}
_HEAD = {"head_top", "chin", "nose", "ear_l", "ear_r"}
_LEG = {"knee", "ankle"}
_FOOT = {"heel", "ball", "toe"}
_ARM = {"elbow", "wrist"}
_HAND = {"hand", "thumb"}


class PeopleSettings(NamedTuple):
    """How far people differ, and how far apart their limbs stay."""

    children: float = 0.25
    """Share of the seeds that give a child: smaller, with a larger head and shorter limbs."""
    eared: float = 0.5
    """Share of the seeds whose surface shows ears."""
    side_length: float = 0.012
    """Standard deviation of the length of a limb of one side, share of it."""
    side_thickness: float = 0.03
    """Standard deviation of the thickness of a limb of one side, share of it."""
    gap: float = 0.02
    """Least gap between limbs, share of the height. Measured between balls, which are thicker than flattened limbs."""
    seconds: float = 7.0
    """Time in which limbs are kept apart, seconds: more than two periods of every motion."""
    times: int = 85
    """Moments of that time that are looked at."""
    calming: tuple[float, ...] = (1.0, 0.9, 0.8, 0.7, 0.55, 0.4)
    """Shares of its extents that a motion is tried with before another is drawn."""
    drafts: int = 40
    """Bodies or motions that are drawn at most."""
    wobble: tuple[float, float] = (0.4, 1.3)
    """Range of the amplitude of the slow movements of every joint, degrees; there are two about random axes."""
    slow: tuple[float, float] = (0.25, 1.1)
    """Range of their frequency, 1/s."""
    frequency: tuple[float, float] = (5.0, 9.0)
    """Range of the frequency of soft flesh on its bone, 1/s; not measured (ours)."""
    bulge: tuple[float, float] = (0.02, 0.07)
    """Range of the share by which a limb swells when the joint beyond bends by a right angle."""


_SETTINGS = PeopleSettings()


def person(description: Mapping[str, Any], motion: str | None, seed: int, clothed: bool = False) -> dict[str, Any]:
    """A figure as data: the given one with proportions and a motion drawn from a seed.

    description : of an adult, with the names of joints of the one that ships
    motion      : one of its motions, the first by name when None; each is drawn without the others
    clothed     : whether loose clothes are worn
    raises      : FigureError at an unknown motion
    """
    motions: Mapping[str, Any] = description["motions"]
    name = min(motions) if motion is None else motion
    if name not in motions:
        raise FigureError(f"the figures {description['name']}:SEED have no motion {name!r}{suggestion(name, motions)}")
    rng = np.random.default_rng([seed, 1760])
    drafts = (_proportioned(description, rng) for _ in range(_SETTINGS.drafts))
    unmoved = next(_apart({**draft, "motions": {}} for draft in drafts))
    size = Figure.of(unmoved).height / Figure.of(description).height
    own = _own_motion(unmoved, motions[name], size, np.random.default_rng([seed, 1761, zlib.crc32(name.encode())]))
    softness = {"frequency": _uniform(rng, _SETTINGS.frequency), "bulge": _uniform(rng, _SETTINGS.bulge), "skin": 1.2}
    figure = {**unmoved, "name": f"{description['name']}-{seed}", "motions": {name: own}, "softness": softness}
    return {**figure, "clothes": outfit(unmoved["joints"], seed)} if clothed else figure


def _uniform(rng: np.random.Generator, between: tuple[float, float]) -> float:
    return round(float(rng.uniform(*between)), 4)


def _apart(drafts: Iterator[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    """Those whose limbs stay apart at rest and in their motion; if none does, the last."""
    draft: dict[str, Any] = {}
    seconds = np.linspace(0.0, _SETTINGS.seconds, _SETTINGS.times)
    for draft in drafts:
        figure = Figure.of(draft)
        R, shift = joint_rotations(figure, figure.motion(None), seconds if figure.motions else seconds[:0])
        X, _ = forward_kinematics(figure.rest, figure.parents, R, shift)
        X = np.concatenate([figure.rest[None], X])
        flesh = Flesh.of(figure)
        near = flesh.neighbours @ flesh.neighbours
        if clearance(figure, flesh, X, ignored=near).min() > _SETTINGS.gap * figure.height:
            yield draft
    yield draft


def _proportioned(description: Mapping[str, Any], rng: np.random.Generator) -> dict[str, Any]:
    """The joints with other bones and thicknesses; every bone keeps its direction but for the shares of its three extents."""
    share = _shares(rng)
    rows = copy.deepcopy(list(description["joints"]))
    if rng.random() >= _SETTINGS.eared:
        rows = [row for row in rows if not row["name"].startswith("ear_")]
    old = {row["name"]: np.array(row["position"], dtype=np.float64) for row in rows}
    limbs = {side: {group: rng.normal(size=2) for group in ("arm", "leg", "hand", "foot")} for side in "lr"}
    new: dict[str, Floats] = {}
    for row in rows:
        name = row["name"]
        extent, thick, uneven = _of_joint(name, share, limbs)
        parent = row.get("parent")
        start, base = (new[parent], old[parent]) if parent else (np.zeros(3), np.zeros(3))
        new[name] = start + (old[name] - base) * extent * (1.0 + _SETTINGS.side_length * uneven[0])
        for key in {"radius", "radii"} & set(row):
            wide = thick * (1.0 + _SETTINGS.side_thickness * uneven[1])
            row[key] = np.round(np.array(row[key]) * wide * share["stature"], 2).tolist()
        if "flesh" in row:
            row["flesh"] = np.round(np.array(row["flesh"]) * thick * share["stature"], 2).tolist()
        row["blend"] = round(float(row.get("blend", 0.7) * share["softness"]), 3)
    for row in rows:
        row["position"] = np.round(new[row["name"]] * share["stature"], 2).tolist()
    return {"name": "person", "unit": description["unit"], "fps": description["fps"], "joints": rows}


def _shares(rng: np.random.Generator) -> dict[str, float]:
    """Proportions of one person, as shares of those of the figure."""
    child = rng.random() < _SETTINGS.children
    stature = rng.uniform(0.6, 0.85) if child else rng.normal(0.97, 0.055)
    weight = float(np.clip(rng.normal(1.0, 0.14), 0.8, 1.32))
    return {
        "stature": float(np.clip(stature, 0.58, 1.13)),
        "weight": weight,
        "belly": weight * float(rng.uniform(0.96, 1.0 + 0.5 * max(weight - 0.9, 0.0))),
        "leg": float(rng.uniform(0.84, 0.95) if child else rng.normal(1.0, 0.045)),
        "arm": float(rng.uniform(0.88, 0.98) if child else rng.normal(1.0, 0.06)),
        "trunk": float(rng.normal(1.0, 0.03)),
        "shoulders": float(rng.uniform(0.84, 0.94) if child else rng.normal(1.0, 0.06)),
        "hips": float(rng.normal(1.0, 0.05)) * max(weight, 1.0) ** 0.9,
        "head": float(rng.uniform(1.12, 1.3) if child else rng.normal(1.0, 0.035)),
        "nose": float(rng.uniform(0.92, 1.2)),
        "hand": float(rng.normal(1.0, 0.05)),
        "foot": float(rng.normal(1.0, 0.05)),
        "softness": float(rng.uniform(0.9, 1.6)),
    }


def _of_joint(name: str, share: Mapping[str, float], limbs: Mapping[str, Any]) -> tuple[Floats, float, Floats]:
    """Shares of the bone to a joint along x, y and z, share of its thickness, and how its side differs."""
    stem, _, side = name.rpartition("_") if name.endswith(("_l", "_r")) else (name, "", "")
    even, weight = np.zeros(2), share["weight"]
    limb = 0.5 + 0.5 * weight
    one = np.ones(3)
    if name in _HEAD:
        return one * share["head"] * (np.array([1.0, share["nose"], 1.0]) if name == "nose" else one), share["head"], even
    if stem == "shoulder":
        return np.array([share["shoulders"], 1.0, share["trunk"]]), limb, even
    if stem == "hip":
        return np.array([share["hips"], 1.0, 1.0]), weight, even
    if stem in _ARM:
        return one * share["arm"], limb, limbs[side]["arm"]
    if stem in _HAND:
        return one * share["hand"], share["hand"], limbs[side]["hand"]
    if stem in _LEG:
        return one * share["leg"], weight if stem == "knee" else limb, limbs[side]["leg"]
    if stem in _FOOT:
        return one * share["foot"], share["foot"], limbs[side]["foot"]
    if name in _TRUNK:
        return one * share["trunk"], share["belly"] if name != "chest" else weight, even
    return one, limb if name == "neck" else share["head"], even


def _own_motion(figure: Mapping[str, Any], curves: Mapping[str, Any], size: float, rng: np.random.Generator) -> dict[str, Any]:
    """One motion as this person does it: the first draft whose limbs stay apart, calmed where that is needed."""
    calmed = ({"m": _varied(figure, curves, calm, size, rng)} for _ in range(_SETTINGS.drafts) for calm in _SETTINGS.calming)
    motion: dict[str, Any] = next(_apart({**figure, "motions": m} for m in calmed))["motions"]["m"]
    return motion


def _varied(
    figure: Mapping[str, Any], curves: Mapping[str, Any], calm: float, size: float, rng: np.random.Generator
) -> dict[str, Any]:
    """The curves with other extents, timing, tempo and start, and slow small movements of every joint they name."""
    tempo, start = float(rng.uniform(0.9, 1.12)), float(rng.uniform(0.0, 3.0))
    carries = {row.get("parent") for row in figure["joints"]}
    varied = {}
    for joint, rows in curves.items():
        late, extent = float(rng.normal(0.0, 0.03)), calm * float(rng.uniform(0.85, 1.15))
        varied[joint] = [_varied_curve(row, tempo, start + late, extent * (size if _slides(row) else 1.0)) for row in rows]
    for joint in sorted({row["name"] for row in figure["joints"]} & carries):
        varied[joint] = [*varied.get(joint, []), *(_wobble(rng) for _ in range(2))]
    return varied


def _slides(row: Mapping[str, Any]) -> bool:
    """Whether a curve shifts the root and does not turn a joint."""
    return "distance" in row or bool(row.get("slides", False))


def _varied_curve(row: Mapping[str, Any], tempo: float, start: float, extent: float) -> dict[str, Any]:
    """One curve faster by the tempo, begun `start` seconds later in it, and its extents times `extent`."""
    own = dict(row)
    if "keys" in row:
        mean = float(np.mean([value for _, value in row["keys"]]))
        own["keys"] = [[round(s / tempo - start, 4), round(mean + (v - mean) * extent, 3)] for s, v in row["keys"]]
        own["period"] = round(row["period"] / tempo, 6)
        return own
    key = "distance" if "distance" in row else "amplitude"
    frequency = row["frequency"] * tempo
    phase = float(np.mod(row.get("phase", 0.0) + frequency * start, 1.0))
    return own | {key: round(row[key] * extent, 3), "frequency": round(frequency, 6), "phase": round(phase, 4)}


def _wobble(rng: np.random.Generator) -> dict[str, Any]:
    """A slow small movement about a random axis."""
    axis = rng.normal(size=3)
    return {
        "axis": np.round(axis / np.linalg.norm(axis), 4).tolist(),
        "amplitude": round(float(rng.uniform(*_SETTINGS.wobble)), 3),
        "frequency": round(float(rng.uniform(*_SETTINGS.slow)), 4),
        "phase": round(float(rng.uniform()), 4),
    }
