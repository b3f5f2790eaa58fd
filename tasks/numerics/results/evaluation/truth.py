"""A true skeleton as somebody wrote it down: truth.json, a skeleton.json of kinetree's own, or a BVH."""

import itertools
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from kinetree.errors import InputError
from kinetree.tasks.numerics.input.synth.motion import turning_angles
from kinetree.tasks.numerics.results.evaluation.bvh import read_bvh

Floats = npt.NDArray[np.float64]
Kind = Literal["joint", "tip"]
SCORED_DEGREES = 15.0
"""A joint that turns less against its parent cannot be asked of a method that sees motion alone."""
SAMPLED = 200
"""Frames of a long clip between which angles are measured."""
KINDS: Mapping[str, Kind] = {"root": "joint", "joint": "joint", "tip": "tip", "leaf": "tip"}
SKELETON = "kinetree.skeleton/1"
LARGEST = 1e50
"""Beyond this nothing can be computed with, whatever the unit."""
METRES = {"mm": 0.001, "cm": 0.01, "dm": 0.1, "m": 1.0, "in": 0.0254, "ft": 0.3048}
"""Units of length that are known to be some share of a metre."""


@dataclass(frozen=True, eq=False)
class TrueMotion:
    """The true joints in every frame, parents before children or not.

    names, parents, kinds : (joint,) name, parent or −1, joint or tip
    turns                 : (joint,) degrees that it turns against its parent over the clip, NaN where nobody says
    scored                : (joint,) whether it should be found
    frames                : (frame,) source frame numbers, ascending
    X                     : (frame, joint, xyz) in the truth's unit
    height                : what errors are a share of, in that unit; None where nobody says
    unit, fps             : None where nobody says
    """

    names: tuple[str, ...]
    parents: tuple[int, ...]
    kinds: tuple[Kind, ...]
    turns: tuple[float, ...]
    scored: tuple[bool, ...]
    frames: tuple[int, ...]
    X: Floats
    height: float | None
    unit: str | None
    fps: float | None


def read_truth(text: str, name: str) -> TrueMotion:
    """The true skeleton in a file's content; `name` with its ending says what it is, and is what messages call it.

    raises : InputError that says what is wrong and what was expected
    """
    ending = name.lower().rpartition(".")[2]
    if ending == "bvh":
        return of_bvh(text, name)
    if ending != "json":
        raise InputError(f"{name}: a truth is a truth.json, as kinetree synth writes it, a skeleton.json or a .bvh file")
    try:
        told = json.loads(text)
    except ValueError as error:
        raise InputError(f"{name}: not JSON: {error}") from None
    except RecursionError:
        raise InputError(f"{name}: lists within lists without end; expected a truth.json") from None
    return of_told(told, name)


def of_bvh(text: str, name: str) -> TrueMotion:
    """The motion of a BVH file; joints are scored where they turn enough, the root never, end sites are tips."""
    clip = read_bvh(text, name)
    turns = turning_angles(clip.R[:: max(1, -(-len(clip.R) // SAMPLED))])
    scored = tuple(
        p >= 0 and not end and bool(turn >= SCORED_DEGREES) for p, end, turn in zip(clip.parents, clip.ends, turns, strict=True)
    )
    return TrueMotion(
        names=clip.names,
        parents=clip.parents,
        kinds=tuple("tip" if end else "joint" for end in clip.ends),
        turns=tuple(map(float, turns)),
        scored=scored,
        frames=tuple(range(len(clip.X))),
        X=_sized(clip.X, name),
        height=None,
        unit=None,
        fps=1.0 / clip.seconds,
    )


def of_told(told: Any, name: str) -> TrueMotion:
    """The true skeleton in what a truth.json says: `joints` with name, parent, kind, and `positions` by frame and joint."""
    if not isinstance(told, Mapping) or not {"joints", "positions"} <= set(told):
        raise InputError(f"{name}: no joints and positions in it; expected a truth.json, as kinetree synth writes it")
    if told.get("format", SKELETON) != SKELETON:
        raise InputError(f"{name}: format {told['format']!r} is not known; {SKELETON} is")
    rows = told["joints"]
    if not isinstance(rows, list) or not rows or not all(isinstance(row, Mapping) and "name" in row for row in rows):
        raise InputError(f"{name}: joints must be a list of objects, each with a name")
    names = tuple(str(row["name"]) for row in rows)
    if len(set(names)) != len(names):
        twice = next(n for n in names if names.count(n) > 1)
        raise InputError(f"{name}: two joints are called {twice!r}; parents are told by name, so each needs its own")
    parents = _parents(rows, names, name)
    kinds = tuple(_kind(row, name) for row in rows)
    if "joint" not in kinds:
        raise InputError(f"{name}: all its joints are tips; a tree has a joint")
    X = _positions(told["positions"], len(rows), name)
    turns = tuple(_number(row.get("turns_deg"), f"{name}: turns_deg of {row['name']}") for row in rows)
    return TrueMotion(
        names=names,
        parents=parents,
        kinds=kinds,
        turns=tuple(float("nan") if turn is None else turn for turn in turns),
        scored=tuple(
            kind == "joint" and bool(row.get("scored", p >= 0 and (turn is None or turn >= SCORED_DEGREES)))
            for row, p, kind, turn in zip(rows, parents, kinds, turns, strict=True)
        ),
        frames=_frames(told.get("frames"), len(X), name),
        X=X,
        height=_positive(told.get("height"), f"{name}: height"),
        unit=_unit(told.get("unit")),
        fps=_positive(told.get("fps"), f"{name}: fps"),
    )


def factor(unit: str | None, wanted: str | None, name: str) -> float:
    """What lengths in `unit` are multiplied by to be in `wanted`; 1 where one of them is unknown.

    raises : InputError where both are known, differ, and one is no unit that can be converted
    """
    if unit is None or wanted is None or unit == wanted:
        return 1.0
    for one in (unit, wanted):
        if one not in METRES:
            raise InputError(f"{name} is in {unit} and the sequence in {wanted}; {one} is none of {', '.join(METRES)}")
    return METRES[unit] / METRES[wanted]


def _parents(rows: Sequence[Mapping[str, Any]], names: tuple[str, ...], name: str) -> tuple[int, ...]:
    """Parents by name, or by number as skeleton.json has them; one root and no ring."""
    found = []
    for row in rows:
        told = row.get("parent")
        if told is None:
            found.append(-1)
        elif type(told) is int and 0 <= told < len(names):
            found.append(told)
        elif told in names:
            found.append(names.index(told))
        else:
            raise InputError(f"{name}: the parent of {row['name']} is {told!r}, which is none of its joints")
    if found.count(-1) != 1:
        raise InputError(f"{name}: {found.count(-1)} joints have no parent; one tree has one root")
    for j in range(len(found)):
        above, steps = j, 0
        while above >= 0:
            above, steps = found[above], steps + 1
            if steps > len(found):
                raise InputError(f"{name}: {names[j]} is below itself; joints must make a tree")
    return tuple(found)


def _kind(row: Mapping[str, Any], name: str) -> Kind:
    kind = row.get("kind", "joint")
    if not isinstance(kind, str) or kind not in KINDS:
        raise InputError(f"{name}: {row['name']} is a {kind!r}; there are {', '.join(KINDS)}")
    return KINDS[kind]


def _positions(told: Any, joints: int, name: str) -> Floats:
    try:
        X = np.array(told, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError(f"{name}: positions must be numbers by frame, joint and xyz, the same for every frame") from None
    if X.ndim != 3 or X.shape[1:] != (joints, 3) or not len(X):
        raise InputError(f"{name}: positions must be (frame, {joints} joints, 3), got {X.shape}")
    if not np.isfinite(X).all():
        frame, joint, _ = np.argwhere(~np.isfinite(X))[0]
        raise InputError(f"{name}: position of joint {joint} in frame {frame} is not finite; a truth must be known everywhere")
    return _sized(X, name)


def _sized(X: Floats, name: str) -> Floats:
    """Positions whose squares are numbers."""
    if np.abs(X).max() > LARGEST:
        raise InputError(f"{name}: positions go up to {np.abs(X).max():.3g}, beyond {LARGEST:g}; no unit makes a body so large")
    return X


def _frames(told: Any, count: int, name: str) -> tuple[int, ...]:
    if told is None:
        return tuple(range(count))
    if not isinstance(told, list) or len(told) != count or not all(type(n) is int for n in told):
        raise InputError(f"{name}: frames must be {count} whole numbers, one for each frame of positions")
    if any(a >= b for a, b in itertools.pairwise(told)):
        raise InputError(f"{name}: frames must ascend")
    return tuple(told)


def _number(told: Any, what: str) -> float | None:
    if told is None:
        return None
    try:
        number = float(told) if isinstance(told, int | float) and not isinstance(told, bool) else np.nan
    except OverflowError:
        number = np.inf
    if not np.isfinite(number):
        raise InputError(f"{what} is {str(told)[:40]!r}, which is no number" if isinstance(told, str) else
                         f"{what} is {str(told)[:40]}, which is no number")
    return number


def _positive(told: Any, what: str) -> float | None:
    number = _number(told, what)
    if number is not None and not 1.0 / LARGEST <= number <= LARGEST:
        raise InputError(f"{what} is {number:g}, expected a number above 0 of a size that occurs")
    return number


def _unit(told: Any) -> str | None:
    return None if told in (None, "", "unknown") else str(told)
