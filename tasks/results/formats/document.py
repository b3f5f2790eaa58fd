"""A skeleton as JSON, and the JSON Schema of that file (ours)."""

import json
from collections.abc import Collection, Sequence
from typing import Any

import numpy as np

from kinetree.schemas.array import Floats
from kinetree.schemas.results.complete_skeleton import Interpolated
from kinetree.schemas.results.skeleton_json import FORMAT, Bone, Document, InterpolatedFrame, Joint, JointError, Rest
from kinetree.schemas.structure.error_bars import ErrorBars
from kinetree.schemas.structure.joint_names import JointNames
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.results.formats.rig import local_offsets, local_rotations, quaternions, rest_frames, seconds

DRAFT = "https://json-schema.org/draft/2020-12/schema"
DIGITS = 9
"""Decimals of quaternions and seconds."""
ERROR_DIGITS = 4
"""Significant digits of expected errors in frames."""


def document(
    skeleton: Skeleton,
    names: JointNames,
    up: UpDirection,
    interpolated: Sequence[Interpolated] = (),
    assumed: Collection[int] = (),
    bars: ErrorBars | None = None,
) -> Document:
    """The content of skeleton.json: joints, rest pose, positions, rotations, confidence and expected errors in every frame.

    interpolated : the frames that were not measured
    assumed      : the joints that were not found
    bars         : expected errors, with frames as the skeleton numbers them; None where none are known
    """
    parents = [None if p < 0 else p for p in skeleton.parents]
    lengths = skeleton.lengths.tolist()
    B = rest_frames(skeleton.rest, skeleton.parents)
    rotations = quaternions(local_rotations(skeleton.rotation, B, skeleton.parents))
    return Document(
        format=FORMAT,
        unit=skeleton.unit,
        fps=skeleton.fps,
        up=up.up,
        up_confidence=up.confidence,
        topology=names.topology,
        front=tuple(np.round(names.front, DIGITS).tolist()) if names.front.any() else None,
        front_confidence=names.front_confidence,
        frames=list(skeleton.frames),
        seconds=None if skeleton.fps is None else np.round(seconds(skeleton, skeleton.fps), DIGITS).tolist(),
        joints=_joints(skeleton, names, B, assumed, bars),
        positions=skeleton.positions.tolist(),
        rotations=np.round(rotations, DIGITS).tolist(),
        bones=[Bone(parent=p, child=j, length=lengths[j]) for j, p in enumerate(parents) if p is not None],
        confidence=skeleton.confidence.tolist(),
        errors=None if bars is None or not bars.cuts else _errors(skeleton, bars),
        interpolated=[InterpolatedFrame(**each.model_dump()) for each in interpolated],
    )


def _errors(skeleton: Skeleton, bars: ErrorBars) -> list[list[float | None]]:
    """Expected errors in every frame, of every joint."""
    column, row = ({key: k for k, key in enumerate(keys)} for keys in (bars.joints, bars.frames))
    table = np.full((len(skeleton.frames), len(skeleton.names)), np.nan)
    for t, frame in enumerate(skeleton.frames):
        if frame in row:
            table[t] = [bars.in_frame[row[frame], column[name]] if name in column else np.nan for name in skeleton.names]
    return [[_rounded(value) for value in line] for line in table.tolist()]


def _rounded(value: float) -> float | None:
    """An expected error with as many digits as it is worth; None for one that is not known."""
    return None if np.isnan(value) else float(f"{value:.{ERROR_DIGITS}g}")


def _joint_error(name: str, bars: ErrorBars | None) -> JointError | None:
    """The expected error of a joint."""
    if bars is None or name not in bars.joints or np.isnan(bars.expected[j := bars.joints.index(name)]):
        return None
    lengths = {field: float(getattr(bars, field)[j]) for field in ("expected", "bound", "drift", "residual")}
    counts = {field: int(getattr(bars, field)[j]) for field in ("agreeing", "support")}
    partial = {field: _rounded(float(getattr(bars, field)[j])) for field in ("spread", "surface_offset", "asymmetry")}
    return JointError(**lengths, **counts, **partial, cuts=bars.cuts)


def _joints(skeleton: Skeleton, names: JointNames, B: Floats, assumed: Collection[int], bars: ErrorBars | None) -> list[Joint]:
    """The joints with their rest pose."""
    offset = local_offsets(skeleton.rest, B, skeleton.parents).tolist()
    identity = np.broadcast_to(np.eye(3), (1, *B.shape))
    rotation = np.round(quaternions(local_rotations(identity, B, skeleton.parents))[0], DIGITS).tolist()
    evidence = {} if bars is None else dict(zip(bars.joints, bars.evidence, strict=True))
    return [
        Joint(
            name=names.names[j],
            anatomy=names.anatomy[j] or None,
            parent=None if skeleton.parents[j] < 0 else skeleton.parents[j],
            kind="assumed" if j in assumed else skeleton.kinds[j],
            range=float(skeleton.degrees[j]),
            rest=Rest(position=tuple(skeleton.rest[j].tolist()), offset=tuple(offset[j]), rotation=tuple(rotation[j])),
            evidence=evidence.get(skeleton.names[j]),
            error=_joint_error(skeleton.names[j], bars),
        )
        for j in range(len(skeleton.names))
    ]


def skeleton_file(
    skeleton: Skeleton,
    names: JointNames,
    up: UpDirection,
    interpolated: Sequence[Interpolated] = (),
    assumed: Collection[int] = (),
    bars: ErrorBars | None = None,
) -> bytes:
    """The file skeleton.json, with one line a frame, so that people and `diff` can read it; for the rest see `document`."""
    fields = document(skeleton, names, up, interpolated, assumed, bars).model_dump(mode="json")
    entries = [f"  {json.dumps(name)}: {_lines(name, value)}" for name, value in fields.items()]
    return ("{\n" + ",\n".join(entries) + "\n}\n").encode()


def schema() -> dict[str, Any]:
    """The JSON Schema of skeleton.json."""
    return {"$schema": DRAFT, "$id": f"urn:{FORMAT.replace('/', ':')}", **Document.model_json_schema()}


def _lines(name: str, value: Any) -> str:
    """One field as JSON; long lists with one line an element."""
    if name in ("joints", "positions", "rotations", "bones", "confidence", "errors") and value:
        return "[\n    " + ",\n    ".join(_text(row) for row in value) + "\n  ]"
    return _text(value)


def _text(value: Any) -> str:
    """A value as JSON in one line."""
    return json.dumps(value, ensure_ascii=True, allow_nan=False)
