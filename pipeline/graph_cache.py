"""The graphs of a product's own packages, kept on disk: to import every task and what it computes with takes seconds, to hash
the texts does not. A kept task says all that its signature says; its function is imported when it is called.

What is kept is named by the digest of all code that can change it. Names of modules are taken from it, so it may name nothing
but tasks, artifacts and parameters in the packages whose code is identified.
"""

import importlib
import inspect
import sys
from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cache, lru_cache
from pathlib import Path
from typing import Any, TypeVar

from kinetree.errors import ClusterError, GraphError
from kinetree.pipeline.graph import AnyTask, Graph
from kinetree.pipeline.identity import kept
from kinetree.pipeline.identity.own_code import CODE_ROOTS, code_state, is_code_as_read, is_own_code, source_of
from kinetree.pipeline.signature import Argument
from kinetree.pipeline.task import Task, load
from kinetree.schemas.array import Artifact, Params

DECLARING = ("task", "graph", "graph_cache")
"""Modules of this folder that decide what a signature says."""
PLAIN = ("name", "is_origin", "on_request", "asks_index", "threads", "retries", "timeout", "memory", "block", "is_linked")
CLASSES = ("params", "sets", "returns", "along", "among")
REMEDY = "delete the folder kinetree/graphs of the user's cache"
Row = Mapping[str, Any]
C = TypeVar("C", Artifact, Params)


def kept_graphs(reference: str) -> Mapping[str, Graph]:
    """The graphs at `module:name`, a mapping of them by name or one alone, called ""; imported where they are not kept.

    raises : GraphError, where they are imported and make no graph
    """
    path = kept.path_of("graphs", {"state": code_state(), "graphs": reference, **_declaring()})
    return _graphs(path, reference)


@lru_cache(maxsize=4)
def _graphs(path: Path, reference: str) -> Mapping[str, Graph]:
    rows = kept.read(path)
    if rows is not None:
        return _Graphs(rows)
    module, _, name = reference.partition(":")
    imported = getattr(importlib.import_module(module), name)
    graphs: Mapping[str, Graph] = {"": imported} if isinstance(imported, Graph) else imported
    tasks = {task.name: task for graph in graphs.values() for task in graph.tasks}
    if is_code_as_read() and all(_is_kept_whole(task) for task in tasks.values()):
        kept.write(path, {name: [_row(task) for task in graph.tasks] for name, graph in graphs.items()})
    return graphs


def import_functions(graph: Graph) -> None:
    """Imports what the tasks of a graph call, before several threads do.

    raises : ClusterError where the code was edited after it was planned with
    """
    later = [task for task in graph.tasks if isinstance(task.function, _Later) and task.module not in sys.modules]
    for task in later:
        load(f"{task.module}:{task.name}")
    if later and not is_code_as_read():
        raise ClusterError("the code of the tasks was edited after this process had planned with it; run again")


class _Graphs(Mapping[str, Graph]):
    """Graphs by name, each made when it is asked for: the schemas of the others are then not imported."""

    def __init__(self, rows: Mapping[str, list[Row]]) -> None:
        self._rows = rows
        self._made: dict[str, Graph] = {}

    def __getitem__(self, name: str) -> Graph:
        if name not in self._made:
            self._made[name] = Graph(tuple(_task(row) for row in self._rows[name]))
            self._made[name].remember_code()
        return self._made[name]

    def __contains__(self, name: object) -> bool:
        return name in self._rows

    def __iter__(self) -> Iterator[str]:
        return iter(self._rows)

    def __len__(self) -> int:
        return len(self._rows)


class _Later:
    """A task's function, imported when it is called."""

    def __init__(self, module: str, name: str, sentences: str | None) -> None:
        self.__module__, self.__name__, self.__doc__ = module, name, sentences

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        return load(f"{self.__module__}:{self.__name__}")(*args, **kwargs)


@cache
def _declaring() -> Mapping[str, str]:
    here = Path(__file__).parent
    return {f"{name}.py": (here / f"{name}.py").read_text(encoding="utf-8") for name in DECLARING}


def _is_kept_whole(task: AnyTask) -> bool:
    """Whether a task that is read again is the same, its function apart."""
    classes = [task.returns, *(a.artifact for a in task.arguments), *(getattr(task, name) for name in CLASSES)]
    if not all(is_own_code(module) for module in (task.module, *(cls.__module__ for cls in classes if cls is not None))):
        return False
    return replace(_task(_row(task)), function=task.function) == task


def _row(task: AnyTask) -> Row:
    """What a task declares, as JSON."""
    return {
        **{name: getattr(task, name) for name in PLAIN},
        **{name: _reference(getattr(task, name)) for name in CLASSES},
        "over": list(task.over),
        "arguments": [[a.name, _reference(a.artifact), a.form, a.previous] for a in task.arguments],
        "module": task.module,
        "line": task.where.rpartition(":")[2],
        "sentences": inspect.getdoc(task.function),
    }


def _task(row: Row) -> AnyTask:
    """The task that a row declares."""
    module = _own(row["module"])
    return Task(
        function=_Later(module, row["name"], row["sentences"]),
        over=tuple(row["over"]),
        arguments=tuple(Argument(name, _artifact(cls), form, previous) for name, cls, form, previous in row["arguments"]),
        where=f"{source_of(module)}:{row['line']}",
        params=_class(row["params"], Params) if row["params"] else None,
        sets=_class(row["sets"], Params) if row["sets"] else None,
        returns=_artifact(row["returns"]),
        along=_artifact(row["along"]) if row["along"] else None,
        among=_artifact(row["among"]) if row["among"] else None,
        **{name: row[name] for name in PLAIN},
    )


def _reference(cls: type | None) -> str | None:
    return f"{cls.__module__}:{cls.__qualname__}" if cls is not None else None


def _artifact(reference: str) -> type[Artifact]:
    return _class(reference, Artifact)


@cache
def _class(reference: str, base: type[C]) -> type[C]:
    module, _, name = reference.partition(":")
    cls = getattr(importlib.import_module(_own(module)), name, None)
    if not (isinstance(cls, type) and issubclass(cls, base)):
        raise GraphError(f"kept graphs name {reference}, which is no {base.__name__}; {REMEDY}")
    return cls


def _own(module: str) -> str:
    if not is_own_code(module):
        raise GraphError(f"kept graphs name {module}, which is none of {', '.join(CODE_ROOTS)}; {REMEDY}")
    return module
