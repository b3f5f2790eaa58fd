"""A skeleton as tables: motion, positions, confidence, angles between bones and bone lengths (ours)."""

import csv
import io
from collections.abc import Mapping, Sequence
from importlib import import_module
from typing import NamedTuple

import numpy as np

from kinetree.errors import ConfigError
from kinetree.schemas.array import Floats
from kinetree.schemas.structure.error_bars import ErrorBars
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.numerics.results.derivatives import Derivatives, derivatives
from kinetree.tasks.results.formats.rig import children, local_rotations, quaternions, rest_frames, seconds

DIGITS = 9
"""Significant digits of every number."""
ERROR_COLUMNS = {
    "expected_error": "expected", "error_bound": "bound", "drift": "drift", "spread": "spread", "residual": "residual",
    "surface_offset": "surface_offset", "asymmetry": "asymmetry", "cuts_agreeing": "agreeing", "frames_seen": "support",
}  # fmt: skip
"""Columns of the table of joints, and the fields of the error bars that they show."""


Column = Sequence[object] | Floats


class Table(NamedTuple):
    """A table: names of the columns, and one list, tuple or array of values for each."""

    columns: Mapping[str, Column]


def tables(skeleton: Skeleton, found: Derivatives | None, bars: ErrorBars | None = None) -> Mapping[str, Table]:
    """All tables by name.

    motion      a row a frame and joint: frame, seconds, joint, position x y z, velocity vx vy vz, acceleration ax ay az,
                rotation qx qy qz qw against the parent as in skeleton.json, confidence
    joints      a row a joint: name, parent, kind, length of its bone, range of its angle in degrees, unit of lengths; whether
                its motion, the body's shape alone or the other side alone shows it; its expected error, a bound that nine of
                ten joints keep, and drift, spread over so many cuts of which so many have the joint, residual, surface
                offset, difference of its bone from the mirror image, frames seen; no such columns where no error is known
    positions   a row a frame: frame, seconds, then x, y, z of every joint
    confidence  a row a frame: frame, seconds, then every joint's confidence, 0 to 1
    errors      a row a frame: frame, seconds, then every joint's expected error; only where errors are known
    angles      a row a frame: frame, seconds, then for every pair of bones with a common joint the angle between them in
                degrees, 180 where they are in line; columns are named parent/joint/child
    bones       parent, child, length, unit
    Lengths are in the sequence's unit. Seconds, velocities and accelerations are empty where the frame rate is not known.
    """
    names, X, parents = skeleton.names, skeleton.positions, skeleton.parents
    pairs, angles = bone_angles(skeleton)
    inner = [j for j, p in enumerate(parents) if p >= 0]
    bones: dict[str, Column] = {
        "parent": [names[parents[j]] for j in inner],
        "child": [names[j] for j in inner],
        "length": skeleton.lengths[inner],
        "unit": [skeleton.unit or ""] * len(inner),
    }
    joints: dict[str, Column] = {
        "joint": names,
        "parent": [names[p] if p >= 0 else "" for p in parents],
        "kind": skeleton.kinds,
        "length": skeleton.lengths,
        "range": skeleton.degrees,
        "unit": [skeleton.unit or ""] * len(names),
        **_error_columns(bars, len(names)),
    }
    return {
        "motion": Table(_motion(skeleton, found)),
        "joints": Table(joints),
        "positions": series(skeleton, [f"{n}.{x}" for n in names for x in "xyz"], X.reshape(len(X), -1)),
        "confidence": series(skeleton, names, skeleton.confidence),
        **({"errors": series(skeleton, names, _errors_in_frames(skeleton, bars))} if bars is not None and bars.cuts else {}),
        "angles": series(skeleton, ["/".join(names[j] for j in pair) for pair in pairs], angles),
        "bones": Table(bones),
    }


def _error_columns(bars: ErrorBars | None, joints: int) -> dict[str, Column]:
    """Expected error, bound and evidence of every joint, NaN for root and leaves; no column where nothing is known."""
    if bars is None or not bars.cuts:
        return {}
    found = {column: np.asarray(getattr(bars, field), np.float64) for column, field in ERROR_COLUMNS.items()}
    found["cuts"] = np.full(joints, float(bars.cuts))
    numbers = {column: np.where(np.isnan(bars.expected), np.nan, values) for column, values in found.items()}
    return {"evidence": [known or "" for known in bars.evidence], **numbers}


def _errors_in_frames(skeleton: Skeleton, bars: ErrorBars) -> Floats:
    """(frame, joint) expected errors; NaN in frames that were not measured."""
    row = {frame: t for t, frame in enumerate(bars.frames)}
    unknown = np.full(len(skeleton.names), np.nan)
    return np.stack([bars.in_frame[row[frame]] if frame in row else unknown for frame in skeleton.frames])


def motion_derivatives(skeleton: Skeleton, window: float, degree: int) -> Derivatives | None:
    """Velocity and acceleration of every joint per second; None where the frame rate is not known."""
    if skeleton.fps is None:
        return None
    return derivatives(np.array(skeleton.positions), seconds(skeleton, skeleton.fps), window, degree)


def table_files(tables: Mapping[str, Table], form: str) -> Mapping[str, bytes]:
    """Files by name: CSV (RFC 4180) in UTF-8, or Parquet.

    raises : ConfigError where Parquet is asked for and the extra is not installed
    """
    write = _parquet if form == "parquet" else _csv
    return {f"{name}.{form}": write(table) for name, table in tables.items()}


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


def _motion(skeleton: Skeleton, found: Derivatives | None) -> dict[str, Column]:
    """The columns of the table of motion: frame by frame, and in each frame joint by joint."""
    frames, joints = skeleton.positions.shape[:2]
    columns: dict[str, Column] = {
        "frame": np.repeat(skeleton.frames, joints).tolist(),
        "seconds": np.repeat(times(skeleton), joints),
        "joint": list(skeleton.names) * frames,
    }
    B = rest_frames(skeleton.rest, skeleton.parents)
    quaternion = quaternions(local_rotations(skeleton.rotation, B, skeleton.parents))
    unknown = np.full_like(skeleton.positions, np.nan)
    velocity, acceleration = (unknown, unknown) if found is None else found[:2]
    for prefix, axes, values in (
        ("", "xyz", skeleton.positions), ("v", "xyz", velocity), ("a", "xyz", acceleration), ("q", "xyzw", quaternion),
    ):  # fmt: skip
        columns |= {f"{prefix}{axis}": values[..., k].ravel() for k, axis in enumerate(axes)}
    return {**columns, "confidence": skeleton.confidence.ravel()}


def series(skeleton: Skeleton, columns: Sequence[str], values: Floats) -> Table:
    """A table with one row a frame."""
    heads: dict[str, Column] = {"frame": skeleton.frames, "seconds": times(skeleton)}
    return Table(heads | {name: values[:, k] for k, name in enumerate(columns)})


def times(skeleton: Skeleton) -> Floats:
    """(frame,) time since the first frame; NaN where the frame rate is not known."""
    return np.full(len(skeleton.frames), np.nan) if skeleton.fps is None else seconds(skeleton, skeleton.fps)


def spreadsheet_cell(value: object) -> object:
    """A value as a cell that no spreadsheet takes for a formula: text that begins like one gets an apostrophe."""
    return f"'{value}" if isinstance(value, str) and value[:1] in ("=", "+", "-", "@", "\t", "\r") else value


def _csv(table: Table) -> bytes:
    """A table as the bytes of a CSV file; unknown numbers are empty."""
    file = io.StringIO()
    writer = csv.writer(file)
    writer.writerow(map(spreadsheet_cell, table.columns))
    columns = [map(_number, c) if isinstance(c, np.ndarray) else map(spreadsheet_cell, c) for c in table.columns.values()]
    writer.writerows(zip(*columns, strict=True))
    return file.getvalue().encode()


def _parquet(table: Table) -> bytes:
    """A table as the bytes of a Parquet file; unknown numbers are null."""
    try:
        arrow, parquet = import_module("pyarrow"), import_module("pyarrow.parquet")
    except ImportError:
        raise ConfigError("Parquet needs a package that is not installed: pip install 'kinetree[parquet]' brings it") from None
    columns = {
        name: arrow.array(values, from_pandas=True) if isinstance(values, np.ndarray) else arrow.array(list(values))
        for name, values in table.columns.items()
    }
    file = io.BytesIO()
    parquet.write_table(arrow.table(columns), file)
    return file.getvalue()


def _number(x: float) -> str:
    """A number as text; nothing for an unknown one."""
    return "" if np.isnan(x) else f"{x:.{DIGITS}g}"
