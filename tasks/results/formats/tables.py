"""A skeleton as tables: a row a frame, a column a joint's coordinate; angles between bones; lengths."""

import csv
import io
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from kinetree.schemas.array import Floats
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.results.formats.rig import children

DIGITS = 9


def tables(skeleton: Skeleton) -> Mapping[str, bytes]:
    """The files by name, as RFC 4180 has them, in UTF-8.

    positions.csv   frame, seconds, then x, y, z of every joint in the sequence's unit
    confidence.csv  frame, seconds, then every joint's confidence, 0 to 1
    angles.csv      frame, seconds, then per pair of bones that meet in a joint the angle between them in degrees, 180 where
                    they are in line; a column is named parent/joint/child
    bones.csv       parent, child, length, unit
    Seconds are empty where nobody knows how fast the sequence is.
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
    """Every parent, joint and child in a row, and (frame, pair) the angle at the joint in degrees, 180 where straight."""
    below, X = children(skeleton.parents), skeleton.positions
    pairs = [(p, j, c) for j, p in enumerate(skeleton.parents) if p >= 0 for c in below[j]]
    angles = np.empty((len(X), len(pairs)))
    for column, (p, j, c) in enumerate(pairs):
        a, b = X[:, p] - X[:, j], X[:, c] - X[:, j]
        sine = np.linalg.norm(np.cross(a, b), axis=1)
        angles[:, column] = np.degrees(np.arctan2(sine, np.sum(a * b, axis=1)))
    return pairs, angles


def _series(skeleton: Skeleton, columns: Sequence[str], values: Floats) -> bytes:
    first = skeleton.frames[0]
    seconds = ["" if skeleton.fps is None else _number((frame - first) / skeleton.fps) for frame in skeleton.frames]
    rows = zip(skeleton.frames, seconds, values, strict=True)
    return _text([("frame", "seconds", *columns), *((frame, at, *map(_number, row)) for frame, at, row in rows)])


def _text(rows: Iterable[Sequence[object]]) -> bytes:
    out = io.StringIO()
    csv.writer(out).writerows(rows)
    return out.getvalue().encode()


def _number(x: float) -> str:
    return f"{x:.{DIGITS}g}"
