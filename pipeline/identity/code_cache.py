"""Code digests of one installation, kept on disk: to read the syntax of every module takes seconds, to hash the texts does not.

A file is named by the digest of all texts that could change what it holds: those of the packages that count, those that
compute digests, and the version of Python.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from kinetree.pipeline.identity import kept

COMPUTING = ("bindings", "code_cache", "definitions", "kept", "key", "modules", "names", "statements")
"""Modules of this folder that decide what a code digest is."""
Identified = tuple[str, dict[str, str]]
"""A code digest, and what it is made of by module."""


@dataclass
class CodeCache:
    """The code digests of one state of the code by task, written as module:name."""

    path: Path
    """Where they are kept."""
    known: dict[str, Identified] = field(default_factory=dict)
    is_changed: bool = False

    @staticmethod
    def of(texts: Mapping[str, str]) -> "CodeCache":
        """What is kept for these texts of modules; nothing where the file is missing, damaged or another's."""
        here = Path(__file__).parent
        own = {f"{name}.py": (here / f"{name}.py").read_text(encoding="utf-8") for name in COMPUTING}
        path = kept.path_of("code", {**texts, **own})
        return CodeCache(path, _identified(kept.read(path)))

    def add(self, task: str, identified: Identified) -> None:
        """Notes the digest of a task, to be written by `save`."""
        self.known[task] = identified
        self.is_changed = True

    def save(self) -> None:
        """Writes what was added; where nothing can be written the next process computes it again."""
        if self.is_changed:
            self.is_changed = False
            kept.write(self.path, self.known)


def _identified(value: object) -> dict[str, Identified]:
    try:
        return {task: (code, dict(parts)) for task, (code, parts) in dict(value or {}).items()}  # type: ignore[call-overload]
    except (TypeError, ValueError):
        return {}
