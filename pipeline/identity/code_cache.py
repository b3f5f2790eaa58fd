"""Code digests of one installation, kept on disk: to read the syntax of every module takes seconds, to hash the texts does not.

A file is named by the digest of all texts that could change what it holds: those of the packages that count, those that
compute digests, and the version of Python. So it is never wrong; at worst it is not there.
"""

import contextlib
import json
import os
import secrets
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from hashlib import blake2b
from pathlib import Path
from typing import Any

FORMAT = "kinetree.code-cache/1"
FILES_KEPT = 8
"""Installations and edits whose digests are kept, the newest ones; one takes about 1 MB."""
COMPUTING = ("bindings", "code_cache", "definitions", "key", "modules", "names", "statements")
"""Modules of this folder that decide what a code digest is."""
Identified = tuple[str, dict[str, str]]
"""A code digest, and what it is made of by module."""


@dataclass
class CodeCache:
    """The code digests of one state of the code by task, written as module:name."""

    path: Path | None
    """Where they are kept; None keeps them nowhere."""
    known: dict[str, Identified] = field(default_factory=dict)
    is_changed: bool = False

    @staticmethod
    def of(texts: Mapping[str, str]) -> "CodeCache":
        """What is kept for these texts of modules; nothing where the file is missing, damaged or another's."""
        path = _folder() / f"{_digest(texts)}.json"
        return CodeCache(path, _read(path))

    def add(self, task: str, identified: Identified) -> None:
        """Notes the digest of a task, to be written by `save`."""
        self.known[task] = identified
        self.is_changed = True

    def save(self) -> None:
        """Writes what was added; where nothing can be written the next process computes it again."""
        if self.path is None or not self.is_changed:
            return
        self.is_changed = False
        content = json.dumps(self.known, sort_keys=True)
        beside = self.path.with_suffix(f".{secrets.token_hex(4)}.tmp")
        with contextlib.suppress(OSError):
            self.path.parent.mkdir(parents=True, exist_ok=True)
            beside.write_text(json.dumps({"format": FORMAT, "sum": _sum(content), "known": content}), encoding="utf-8")
            beside.replace(self.path)
            _forget_old(self.path.parent)


def _folder() -> Path:
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "kinetree" / "code"


def _digest(texts: Mapping[str, str]) -> str:
    here = Path(__file__).parent
    own = {f"{name}.py": (here / f"{name}.py").read_text(encoding="utf-8") for name in COMPUTING}
    h = blake2b(digest_size=20)
    for name, text in [*sorted(texts.items()), *sorted(own.items()), ("python", sys.version)]:
        for part in (name.encode(), text.encode()):
            h.update(len(part).to_bytes(8, "big") + part)
    return h.hexdigest()


def _read(path: Path) -> dict[str, Identified]:
    try:
        kept: Any = json.loads(path.read_text(encoding="utf-8"))
        if kept["format"] != FORMAT or kept["sum"] != _sum(kept["known"]):
            return {}
        return {task: (code, dict(parts)) for task, (code, parts) in json.loads(kept["known"]).items()}
    except (OSError, ValueError, TypeError, KeyError, AttributeError):
        return {}


def _sum(content: str) -> str:
    return blake2b(content.encode(), digest_size=20).hexdigest()


def _forget_old(folder: Path) -> None:
    files = sorted(folder.glob("*.json"), key=lambda file: file.stat().st_mtime, reverse=True)
    for file in files[FILES_KEPT:]:
        file.unlink(missing_ok=True)
