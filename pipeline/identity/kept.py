"""JSON that is kept on disk under the digest of all it was made from, so that it is never wrong; at worst it is not there."""

import contextlib
import json
import os
import secrets
import sys
from collections.abc import Mapping
from hashlib import blake2b
from pathlib import Path
from typing import Any

FILES_KEPT = 16
"""Files of one kind that are kept, those used last: installations and edits. One takes at most 1 MB."""
KIND = "kinetree.kept/1"


def path_of(kind: str, texts: Mapping[str, str]) -> Path:
    """The file of the user's own cache for what is made from these texts, by name, and by this version of Python.

    kind : the folder
    """
    h = blake2b(digest_size=20)
    for name, text in [*sorted(texts.items()), ("python", sys.version)]:
        for part in (name.encode(), text.encode()):
            h.update(len(part).to_bytes(8, "big") + part)
    root = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return root / "kinetree" / kind / f"{h.hexdigest()}.json"


def read(path: Path) -> Any:
    """What was kept there; None where nothing was, or where it was altered."""
    try:
        value: Any = json.loads(path.read_text(encoding="utf-8"))
        if value["format"] != KIND or value["sum"] != _sum(value["content"]):
            return None
        with contextlib.suppress(OSError):
            os.utime(path)  # it is used: others go first
        return json.loads(value["content"])
    except (OSError, ValueError, TypeError, KeyError, AttributeError):
        return None


def write(path: Path, value: Any) -> None:
    """Keeps a value; where nothing can be written the next process makes it again."""
    content = json.dumps(value, sort_keys=True)
    beside = path.with_suffix(f".{secrets.token_hex(4)}.tmp")
    with contextlib.suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        beside.write_text(json.dumps({"format": KIND, "sum": _sum(content), "content": content}), encoding="utf-8")
        beside.replace(path)
        files = sorted(path.parent.glob("*.json"), key=lambda file: file.stat().st_mtime, reverse=True)
        for file in files[FILES_KEPT:]:
            file.unlink(missing_ok=True)


def _sum(content: str) -> str:
    return blake2b(content.encode(), digest_size=20).hexdigest()
