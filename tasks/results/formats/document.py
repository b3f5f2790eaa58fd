"""A skeleton as JSON, and the JSON Schema of that file (ours)."""

import json
from typing import Any

from kinetree.schemas.results.skeleton_json import FORMAT, Bone, Document, Joint
from kinetree.schemas.structure.skeleton import Skeleton

DRAFT = "https://json-schema.org/draft/2020-12/schema"


def document(skeleton: Skeleton) -> Document:
    """The content of skeleton.json: joints, bones, positions and confidence."""
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


def skeleton_file(skeleton: Skeleton) -> bytes:
    """The file skeleton.json, with one line a frame, so that people and `diff` can read it."""
    fields = document(skeleton).model_dump(mode="json")
    entries = [f"  {json.dumps(name)}: {_lines(name, value)}" for name, value in fields.items()]
    return ("{\n" + ",\n".join(entries) + "\n}\n").encode()


def schema() -> dict[str, Any]:
    """The JSON Schema of skeleton.json."""
    return {"$schema": DRAFT, "$id": f"urn:{FORMAT.replace('/', ':')}", **Document.model_json_schema()}


def _lines(name: str, value: Any) -> str:
    """One field as JSON; long lists with one line an element."""
    if name in ("joints", "positions", "bones", "confidence") and value:
        return "[\n    " + ",\n    ".join(_text(row) for row in value) + "\n  ]"
    return _text(value)


def _text(value: Any) -> str:
    """A value as JSON in one line."""
    return json.dumps(value, ensure_ascii=True, allow_nan=False)
