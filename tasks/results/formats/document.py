"""A skeleton as JSON, and the JSON Schema of that file."""

import json
from typing import Any

from kinetree.schemas.results.skeleton_json import FORMAT, Bone, Document, Joint
from kinetree.schemas.structure.skeleton import Skeleton

DRAFT = "https://json-schema.org/draft/2020-12/schema"


def document(skeleton: Skeleton) -> Document:
    """The skeleton's joints, bones, positions and confidence."""
    parents = [None if p < 0 else p for p in skeleton.parents]
    rows = zip(skeleton.names, parents, skeleton.kinds, strict=True)
    lengths = skeleton.lengths.tolist()
    return Document(
        format=FORMAT,
        unit=skeleton.unit,
        fps=skeleton.fps,
        frames=list(skeleton.frames),
        joints=[Joint(name=name, parent=parent, kind=kind) for name, parent, kind in rows],
        positions=skeleton.positions.tolist(),
        bones=[Bone(parent=p, child=j, length=lengths[j]) for j, p in enumerate(parents) if p is not None],
        confidence=skeleton.confidence.tolist(),
    )


def written(skeleton: Skeleton) -> bytes:
    """The file: one line a frame, so that people and `diff` can read it."""
    told = document(skeleton).model_dump(mode="json")
    fields = [f"  {json.dumps(name)}: {_lines(name, value)}" for name, value in told.items()]
    return ("{\n" + ",\n".join(fields) + "\n}\n").encode()


def schema() -> dict[str, Any]:
    """The JSON Schema of the file."""
    return {"$schema": DRAFT, "$id": f"urn:{FORMAT.replace('/', ':')}", **Document.model_json_schema()}


def _lines(name: str, value: Any) -> str:
    if name in ("joints", "positions", "bones", "confidence") and value:
        return "[\n    " + ",\n    ".join(_text(row) for row in value) + "\n  ]"
    return _text(value)


def _text(value: Any) -> str:
    return json.dumps(value, ensure_ascii=True, allow_nan=False)
