"""Reads a true skeleton: a truth.json, a skeleton.json of kinetree, or a BVH file (2014, Sec. 7.1)."""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np

from kinetree.errors import InputError
from kinetree.errors.small_text import small_json
from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.results.bvh_reader import LARGEST_NUMBER, read_bvh

Kind = Literal["joint", "tip"]
KINDS: Mapping[str, Kind] = {"root": "joint", "joint": "joint", "tip": "tip", "leaf": "tip"}
"""The kinds of joints in a file, and what each of them is here."""
ASSUMED = "assumed"
"""The kind of joints of which nothing was measured: they are left out."""
SKELETON_FORMATS = ("kinetree.skeleton/1", "kinetree.skeleton/2")


class TruthSettings(NamedTuple):
    """Which true joints are scored where the file does not say."""

    scored_degrees: float = 15.0
    """Least range of turning against the parent over the clip, degrees, with which a joint is scored: a method that sees only
    motion cannot find one that turns less. Not recorded what it was chosen on."""
    sampled_frames: int = 200
    """Frames of a long clip between which turning is measured, evenly spread; more take quadratic time."""


@dataclass(frozen=True, eq=False)
class TrueMotion:
    """The true joints in every frame, in any order.

    names   : (joint,) unique
    parents : (joint,) parent of every joint, −1 for the root
    kinds   : (joint,) joint: may turn; tip: the end of a bone
    turns   : (joint,) range of turning against the parent over the clip, degrees; NaN where it is not known
    scored  : (joint,) whether a result should have it
    frames  : (frame,) source frame numbers, ascending
    numbered: whether the file states them; else they are 0, 1, 2, …
    X       : (frame, joint, xyz) in the truth's unit
    height  : of the body, in the truth's unit; errors are given as shares of it; None where it is not known
    unit    : of lengths; None where it is not known
    fps     : frames a second; None where it is not known
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
    numbered: bool = False


def read_truth(text: str, name: str) -> TrueMotion:
    """The true skeleton in the content of a file.

    text   : content of the file
    name   : name of the file, for messages; its ending says the format: .bvh or .json
    raises : InputError where the content is not a truth
    """
    ending = name.lower().rpartition(".")[2]
    if ending == "bvh":
        return truth_of_bvh(text, name)
    if ending != "json":
        raise InputError(f"{name}: a truth is a truth.json, as kinetree synth writes it, a skeleton.json or a .bvh file")
    return truth_of_json(small_json(text, name), name)


def truth_of_bvh(text: str, name: str, settings: TruthSettings | None = None) -> TrueMotion:
    """The motion of a BVH file; joints are scored where they turn enough, the root never; end sites are tips.

    text   : content of the file
    name   : name of the file, for messages
    raises : InputError where it is not a BVH
    """
    # a plan without a truth does without scipy
    from kinetree.tasks.numerics.input.synth.motion import turning_angles

    limit = settings or TruthSettings()
    clip = read_bvh(text, name)
    turns = turning_angles(clip.R[:: max(1, -(-len(clip.R) // limit.sampled_frames))])
    scored = tuple(
        p >= 0 and not end and bool(turn >= limit.scored_degrees)
        for p, end, turn in zip(clip.parents, clip.is_end_site, turns, strict=True)
    )
    return TrueMotion(
        names=clip.names,
        parents=clip.parents,
        kinds=tuple("tip" if end else "joint" for end in clip.is_end_site),
        turns=tuple(map(float, turns)),
        scored=scored,
        frames=tuple(range(len(clip.X))),
        X=_sized(clip.X, name),
        height=None,
        unit=None,
        fps=1.0 / clip.frame_time,
    )


def truth_of_json(content: Any, name: str, settings: TruthSettings | None = None) -> TrueMotion:
    """The true skeleton in a truth.json: `joints` with name, parent and kind, and `positions` by frame and joint.

    Of joints that another run assumed, nothing is known: they are left out.

    content : what the JSON holds
    name    : name of the file, for messages
    raises  : InputError where it is not a truth
    """
    # a plan without a truth does without scipy
    from kinetree.tasks.numerics.results.evaluation.tree_edit import contracted_tree

    if not isinstance(content, Mapping) or not {"joints", "positions"} <= set(content):
        raise InputError(f"{name}: it has no joints and positions; expected a truth.json, as kinetree synth writes it")
    if content.get("format", SKELETON_FORMATS[0]) not in SKELETON_FORMATS:
        raise InputError(f"{name}: format {content['format']!r} is not known; {' and '.join(SKELETON_FORMATS)} are")
    least_turn = (settings or TruthSettings()).scored_degrees
    rows = content["joints"]
    if not isinstance(rows, list) or not rows or not all(isinstance(row, Mapping) and "name" in row for row in rows):
        raise InputError(f"{name}: joints must be a list of objects, each with a name")
    names = tuple(str(row["name"]) for row in rows)
    if len(set(names)) != len(names):
        twice = next(n for n in names if names.count(n) > 1)
        raise InputError(f"{name}: two joints are called {twice!r}; parents are given by name, so names must be unique")
    parents = _parents(rows, names, name)
    remains = [p < 0 or row.get("kind") != ASSUMED for row, p in zip(rows, parents, strict=True)]
    every, rows = len(rows), [row for row, stays in zip(rows, remains, strict=True) if stays]
    names, parents = tuple(str(row["name"]) for row in rows), tuple(contracted_tree(parents, remains))
    kinds = tuple(_kind(row, name) for row in rows)
    if "joint" not in kinds:
        raise InputError(f"{name}: all its joints are tips; at least one must be a joint")
    X = _positions(content["positions"], every, name)[:, remains]
    turns = tuple(_number(row.get("turns_deg"), f"{name}: turns_deg of {row['name']}") for row in rows)
    return TrueMotion(
        names=names,
        parents=parents,
        kinds=kinds,
        turns=tuple(float("nan") if turn is None else turn for turn in turns),
        scored=tuple(
            kind == "joint" and bool(row.get("scored", p >= 0 and (turn is None or turn >= least_turn)))
            for row, p, kind, turn in zip(rows, parents, kinds, turns, strict=True)
        ),
        frames=_frames(content.get("frames"), len(X), name),
        X=X,
        height=_positive(content.get("height"), f"{name}: height"),
        unit=_unit(content.get("unit")),
        fps=_positive(content.get("fps"), f"{name}: fps"),
        numbered=content.get("frames") is not None,
    )


def _parents(rows: Sequence[Mapping[str, Any]], names: tuple[str, ...], name: str) -> tuple[int, ...]:
    """The parent of every joint, given by name or, as in skeleton.json, by number; refuses what is not one tree."""
    parents = []
    for row in rows:
        parent = row.get("parent")
        if parent is None:
            parents.append(-1)
        elif type(parent) is int and 0 <= parent < len(names):
            parents.append(parent)
        elif parent in names:
            parents.append(names.index(parent))
        else:
            raise InputError(f"{name}: the parent of {row['name']} is {parent!r}, which is none of its joints")
    if parents.count(-1) != 1:
        raise InputError(f"{name}: {parents.count(-1)} joints have no parent; a tree has exactly one root")
    for j in range(len(parents)):
        above, steps = j, 0
        while above >= 0:
            above, steps = parents[above], steps + 1
            if steps > len(parents):
                raise InputError(f"{name}: {names[j]} is its own ancestor; joints must form a tree")
    return tuple(parents)


def _kind(row: Mapping[str, Any], name: str) -> Kind:
    """Whether the joint of a row is a joint or a tip."""
    kind = row.get("kind", "joint")
    if not isinstance(kind, str) or kind not in KINDS:
        raise InputError(f"{name}: {row['name']} has kind {kind!r}; expected one of {', '.join(KINDS)}")
    return KINDS[kind]


def _positions(rows: Any, joints: int, name: str) -> Floats:
    """(frame, joint, xyz) positions, all finite."""
    try:
        X = np.array(rows, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError(f"{name}: positions must be numbers by frame, joint and xyz, equally many in every frame") from None
    if X.ndim != 3 or X.shape[1:] != (joints, 3) or not len(X):
        raise InputError(f"{name}: positions must be (frame, {joints} joints, 3), got {X.shape}")
    if not np.isfinite(X).all():
        frame, joint, _ = np.argwhere(~np.isfinite(X))[0]
        raise InputError(
            f"{name}: position of joint {joint} in frame {frame} is not finite; a truth has all joints in all frames"
        )
    return _sized(X, name)


def _sized(X: Floats, name: str) -> Floats:
    """The positions, if their squares can be computed."""
    largest = np.abs(X).max()
    if largest > LARGEST_NUMBER:
        raise InputError(f"{name}: positions go up to {largest:.3g}, beyond {LARGEST_NUMBER:g}; no unit makes a body so large")
    return X


def _frames(numbers: Any, count: int, name: str) -> tuple[int, ...]:
    """Source frame numbers; 0, 1, 2, … where the file has none."""
    if numbers is None:
        return tuple(range(count))
    if not isinstance(numbers, list) or len(numbers) != count or not all(type(n) is int for n in numbers):
        raise InputError(f"{name}: frames must be {count} whole numbers, one for each frame of positions")
    if any(a >= b for a, b in itertools.pairwise(numbers)):
        raise InputError(f"{name}: frames must ascend")
    return tuple(numbers)


def _number(value: Any, what: str) -> float | None:
    """A finite number, or None where there is none."""
    if value is None:
        return None
    try:
        number = float(value) if isinstance(value, int | float) and not isinstance(value, bool) else np.nan
    except OverflowError:
        number = np.inf
    if not np.isfinite(number):
        text = repr(value[:40]) if isinstance(value, str) else str(value)[:40]
        raise InputError(f"{what} is {text}, which is not a finite number")
    return number


def _positive(value: Any, what: str) -> float | None:
    """A number above 0 with which one can compute, or None where there is none."""
    number = _number(value, what)
    if number is not None and not 1.0 / LARGEST_NUMBER <= number <= LARGEST_NUMBER:
        least = 1.0 / LARGEST_NUMBER
        raise InputError(f"{what} is {number:g}; expected a positive number from {least:g} to {LARGEST_NUMBER:g}")
    return number


def _unit(text: Any) -> str | None:
    """The unit, or None where the file does not know it."""
    return None if text in (None, "", "unknown") else str(text)
