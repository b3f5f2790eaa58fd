"""A skeleton as tables: positions, confidence, angles between bones and bone lengths (ours)."""

import csv
import io
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from kinetree.schemas.array import Floats
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.results.formats.rig import children

DIGITS = 9
"""Significant digits of every number."""


def tables(skeleton: Skeleton) -> Mapping[str, bytes]:
    """CSV files by name (RFC 4180), in UTF-8.

    positions.csv   frame, seconds, then x, y, z of every joint in the sequence's unit
    confidence.csv  frame, seconds, then every joint's confidence, 0 to 1
    angles.csv      frame, seconds, then for every pair of bones with a common joint the angle between them in degrees, 180
                    where they are in line; columns are named parent/joint/child
    bones.csv       parent, child, length, unit
    Seconds are empty where the frame rate is not known.
    """
    names, X = skeleton.names, skeleton.positions
    pairs, angles = bone_angles(skeleton)
    lengths = skeleton.lengths
    bones = [(names[p], names[j], _number(lengths[j]), skeleton.unit or "") for j, p in enumerate(skeleton.parents) if p >= 0]
    return {
        "positions.csv": _series(skeleton, [f"{n}.{x}" for n in names for x in "xyz"], X.reshape(len(X), -1)),
        "confidence.csv": _series(skeleton, names, skeleton.confidence),
        "angles.csv": _series(skeleton, ["/".join(names[j] for j in pair) for pair in pairs], angles),
        "bones.csv": _text([("parent", "child", "length", "unit"), *bones]),
    }


def bone_angles(skeleton: Skeleton) -> tuple[list[tuple[int, int, int]], Floats]:
    """Angles between bones with a common joint.

    returns : (parent, joint, child) of every pair of bones; (frame, pair) degrees, 180 where the bones are in line
    """
    below, X = children(skeleton.parents), skeleton.positions
    pairs = [(p, j, c) for j, p in enumerate(skeleton.parents) if p >= 0 for c in below[j]]
    angles = np.empty((len(X), len(pairs)))
    for column, (p, j, c) in enumerate(pairs):
        a, b = X[:, p] - X[:, j], X[:, c] - X[:, j]
        sine = np.linalg.norm(np.cross(a, b), axis=1)
        angles[:, column] = np.degrees(np.arctan2(sine, np.sum(a * b, axis=1)))
    return pairs, angles


def _series(skeleton: Skeleton, columns: Sequence[str], values: Floats) -> bytes:
    """A table with one row a frame."""
    first = skeleton.frames[0]
    seconds = ["" if skeleton.fps is None else _number((frame - first) / skeleton.fps) for frame in skeleton.frames]
    rows = zip(skeleton.frames, seconds, values, strict=True)
    return _text([("frame", "seconds", *columns), *((frame, at, *map(_number, row)) for frame, at, row in rows)])


def _text(rows: Iterable[Sequence[object]]) -> bytes:
    """Rows as the bytes of a CSV file."""
    file = io.StringIO()
    csv.writer(file).writerows(rows)
    return file.getvalue().encode()


def _number(x: float) -> str:
    """A number as text."""
    return f"{x:.{DIGITS}g}"
