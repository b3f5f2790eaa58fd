"""Writes schemas/artifact_of_task.pyi anew; a test fails where that was forgotten."""

from collections import defaultdict
from pathlib import Path

from kinetree.schemas.array import Artifact
from kinetree.tasks.methods import DATA_SETS, METHODS

STUB = Path(__file__).resolve().parent.parent / "schemas" / "artifact_of_task.pyi"
LINE = 128
HEAD = '''"""The class of artifact that each task writes, by the task's name: what `artifact("skeleton")` is to a type checker.

Written by `make artifact-types` from the graphs of all methods; a module for type checkers alone.
"""
'''
PROTOCOL = '''
A = TypeVar("A", bound=Artifact)

class ArtifactOfTask(Protocol):
    """The artifact of a class or of a task's name at an index; of a name that no task of ours has, any artifact."""

    @overload
    def __call__(self, what: type[A], **index: int) -> A: ...
'''


def stub() -> str:
    """The text of the file."""
    names: defaultdict[type[Artifact], set[str]] = defaultdict(set)
    for graph in (*METHODS.values(), DATA_SETS):
        for task in graph.tasks:
            names[task.returns].add(task.name)
    modules: defaultdict[str, set[str]] = defaultdict(set)
    for artifact in (*names, Artifact):
        modules[artifact.__module__].add(artifact.__name__)
    imports = [_import(module, sorted(classes)) for module, classes in sorted(modules.items())]
    overloads = [_overload(sorted(of), artifact) for artifact, of in sorted(names.items(), key=lambda row: min(row[1]))]
    end = "    @overload\n    def __call__(self, what: str, **index: int) -> Artifact: ...\n"
    typing = "from typing import Literal, Protocol, TypeVar, overload\n\n"
    return "".join([HEAD, "\n", typing, *imports, PROTOCOL, *overloads, end])


def _import(module: str, classes: list[str]) -> str:
    return f"from {module} import {', '.join(classes)}\n"


def _overload(names: list[str], artifact: type[Artifact]) -> str:
    literal = ", ".join(f'"{name}"' for name in names)
    line = f"    def __call__(self, what: Literal[{literal}], **index: int) -> {artifact.__name__}: ...\n"
    if len(line) > LINE:
        line = f"    def __call__(\n        self, what: Literal[{literal}], **index: int\n    ) -> {artifact.__name__}: ...\n"
    return f"    @overload\n{line}"


if __name__ == "__main__":
    STUB.write_text(stub(), encoding="utf-8")
