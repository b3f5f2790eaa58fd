"""`@task` and `@origin`: a pure function whose signature is its place in the graph.

    @task(over="frame")
    def geodesics(mesh: Mesh, params: GeodesicsParams) -> Geodesics:

The argument types are the edges (`pipeline/signature.py` says how they read), the return type is what the task writes, `params`
is the only configuration it sees, `over` is its fan-out: a path of dimensions from the outermost in, "" (once), "frame",
"interval/cone", … .

A task that names an artifact class as `along` goes along the traversal which that artifact orders, and may read at the
previous member of it: its own artifact, or what other tasks made there. Such edges are no part of the order of tasks, so a
task may read at the previous member what is made from its own artifact (a pass that learns from the pass before).

A task that names an artifact class as `among` gathers only the members that this artifact selects. The selection itself is in
no key: what was gathered is, by its data.

A task over some fan-out that takes `index: Index` is told which member it is; only then the index is part of its key.

The decorated function stays the plain function it was: tests call it with values.
"""

import gc
import importlib
import inspect
import re
import sys
import typing
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Generic, ParamSpec, TypeVar

from kinetree.errors import GraphError
from kinetree.pipeline.signature import Argument, argument_of, artifact_of
from kinetree.pipeline.signature import Previous as Previous
from kinetree.schemas.array import Artifact, Index, Params

P = ParamSpec("P")
R = TypeVar("R")
Space = tuple[str, ...]


@dataclass(frozen=True)
class Task(Generic[P, R]):
    """A declared operation; calling it calls the function."""

    name: str
    function: Callable[P, R]
    over: Space
    arguments: tuple[Argument, ...]
    params: type[Params] | None
    returns: type[Artifact]
    along: type[Artifact] | None
    is_origin: bool
    where: str
    among: type[Artifact] | None = None
    """The artifact class that selects which members of a dimension are gathered; None gathers all."""
    on_request: bool = False
    """Whether it runs only when it is named."""
    asks_index: bool = False
    """Whether it is told its index, which then is part of its key."""
    threads: int = 1
    """How many threads its libraries use."""
    retries: int = 1
    """How often a node is tried again, alone, after dask gave it up because its workers died, or after its time was over."""
    timeout: float | None = None
    """Seconds that one node may take on a worker; None sets no limit."""
    memory: int | None = None
    """Bytes that one node needs while it is computed; None takes what earlier nodes of the task needed."""
    block: str = ""
    """The block of the configuration that sets it: its own name, or that of another task whose block has all its parameters."""
    sets: type[Params] | None = None
    """All parameters of its own block, of which it may see a part alone; None where it has no block of its own."""
    is_linked: bool = False
    """Whether its artifacts were made by another graph and are read from the store by digest."""

    def __call__(self, *args: P.args, **kwargs: P.kwargs) -> R:
        """The function itself."""
        return self.function(*args, **kwargs)

    def __repr__(self) -> str:
        """The signature in one line, e.g. Task(mesh: Source → Mesh per frame)."""
        reads = ", ".join(a.artifact.__name__ for a in self.arguments) or "the world outside"
        per = f" per {'/'.join(self.over)}" if self.over else ""
        return f"Task({self.name}: {reads} → {self.returns.__name__}{per})"

    @property
    def traversed(self) -> str:
        """The dimension whose members the traversal orders; empty without a traversal."""
        return (self.along.orders or self.over[-1]) if self.along else ""

    @property
    def is_chain(self) -> bool:
        """Whether its nodes wait for each other, one after the other."""
        return self.along is not None and self.traversed == self.over[-1]

    @property
    def module(self) -> str:
        """The module that defines the function; a worker imports it by this name."""
        return self.function.__module__

    @property
    def summary(self) -> str:
        """First sentence of the docstring, without the citation."""
        text = " ".join((inspect.getdoc(self.function) or "").split("\n\n")[0].split())
        return re.sub(r"\s*\((20\d\d|ours)[^)]*\)", "", text)

    @property
    def paper(self) -> str:
        """The paper's section or equation, as the docstring cites it in brackets; empty where it cites none."""
        reference = re.search(r"\(((20\d\d|ours)[^)]*)\)", inspect.getdoc(self.function) or "")
        return reference.group(1) if reference else ""


def task(
    *,
    over: str = "",
    along: type[Artifact] | None = None,
    among: type[Artifact] | None = None,
    on_request: bool = False,
    threads: int = 1,
    retries: int = 1,
    timeout: float | None = None,
    memory: int | None = None,
    block: str | type[Params] | None = None,
) -> Callable[[Callable[P, R]], Task[P, R]]:
    """Declares a function as a task; see the module's docstring for what its signature says.

    over       : the fan-out, a path of dimensions; "" runs once
    along      : the artifact class whose `previous` orders the traversal, for a task that reads at the previous member
    among      : the artifact class whose `selected` says which members of its dimension are gathered; None gathers all
    on_request : whether a run leaves it out unless it is named, or something that reads it
    threads    : how many threads its libraries (BLAS, OpenMP, numba) use; more than one has a process to itself
    retries    : how often a node is tried again, alone, after dask gave it up because its workers died, or after `timeout`;
                 an error of the task is never tried again. With 0 every node travels alone, not in a parcel with others
    timeout    : seconds that one node may take; its worker process is then ended and started anew. A thread of the run's own
                 process cannot be ended: it is given up and goes on. The executor `sync` has no limit
    memory     : bytes that one node needs; workers that declare a resource `memory` compute no more at a time than fits.
                 None takes the most that a node of the task was measured to need
    block      : for a task that another's block of the configuration sets, the name of that block; for a task whose own block
                 has more parameters than it reads, the class of them all, which extends that of `params`. A task sees the
                 fields of its own class of params alone, and no other is in its keys
    raises     : GraphError, at import, where the signature does not say enough
    """

    def declare(function: Callable[P, R]) -> Task[P, R]:
        declared = _declared(function, over, along, is_origin=False)
        place = f"{declared.name} ({declared.where})"
        if threads < 1 or retries < 0:
            raise GraphError(f"{place}: threads is {threads} and retries is {retries}; expected at least 1 and 0")
        if (timeout is not None and not timeout > 0) or (memory is not None and memory < 1):
            raise GraphError(f"{place}: timeout is {timeout} and memory is {memory}; expected more than 0 seconds and bytes")
        if among is not None and not among.selects:
            raise GraphError(f"{place}: is among {among.__name__}, which selects nothing")
        limited = replace(declared, threads=threads, retries=retries, timeout=timeout, memory=memory)
        limited = replace(limited, **_block(declared, block, place))
        return replace(limited, among=among, on_request=on_request)

    return declare


def origin(*, over: str = "") -> Callable[[Callable[P, R]], Task[P, R]]:
    """Declares a function that looks at the world outside: run while planning, never by a worker.

    It takes its params and `files` (digests of files, remembered) and returns a mapping from member to artifact; the
    members it returns are the fan-out that tasks over the same space run over.
    """

    def declare(function: Callable[P, R]) -> Task[P, R]:
        return _declared(function, over, None, is_origin=True)

    return declare


def linked(made_by: Task[P, R], *, over: str) -> Task[P, R]:
    """A task of another graph as one that stands at the beginning of this one: its artifacts are there already.

    over : the dimension of the members whose artifacts they are; another origin's artifact opens it
    """
    beginning = replace(made_by, over=space(over), arguments=(), params=None, sets=None, along=None, asks_index=False)
    return replace(beginning, is_origin=True, is_linked=True, on_request=False)


def load(reference: str) -> "Task[..., Any]":
    """The task that `module:name` names, for a worker that was only told its name."""
    module, _, name = reference.partition(":")
    collects = gc.isenabled() and module not in sys.modules
    if collects:  # what an import makes stays; to look through it for garbage takes a tenth of the time
        gc.disable()
    try:
        named = getattr(importlib.import_module(module), name)
    finally:
        if collects:
            gc.enable()
    if not isinstance(named, Task):
        raise GraphError(f"{reference} is not a task")
    return named


def space(path: str) -> Space:
    """The dimensions of a path such as "interval/cone"."""
    return tuple(path.split("/")) if path else ()


def _declared(function: Callable[P, R], over: str, along: type[Artifact] | None, *, is_origin: bool) -> Task[P, R]:
    where = f"{inspect.getsourcefile(function)}:{function.__code__.co_firstlineno}"
    place = f"{function.__name__} ({where})"
    hints = typing.get_type_hints(function, include_extras=True)
    returns = artifact_of(hints.pop("return", None), place, is_origin=is_origin)
    params: type[Params] | None = None
    asks_index = False
    arguments: list[Argument] = []
    for name, parameter in inspect.signature(function).parameters.items():
        hint = hints.get(name)
        if parameter.kind not in (parameter.POSITIONAL_OR_KEYWORD, parameter.KEYWORD_ONLY):
            raise GraphError(f"{place}: argument {parameter} must have a name of its own; tasks are called by keyword")
        if name == "params":
            if not (isinstance(hint, type) and issubclass(hint, Params)):
                raise GraphError(f"{place}: params must be annotated with a class of Params, got {hint!r}")
            params = hint
        elif name == "index":
            if hint != Index:
                raise GraphError(f"{place}: index must be annotated with Index, got {hint!r}")
            asks_index = True
        elif not (is_origin and name == "files"):
            arguments.append(argument_of(name, hint, returns, place))
    if is_origin and (arguments or asks_index):
        raise GraphError(f"{place}: an origin takes params and files alone, got {arguments[0].name if arguments else 'index'}")
    if is_origin and (params is None or "files" not in inspect.signature(function).parameters):
        raise GraphError(f"{place}: an origin takes both params and files, one of them is missing")
    declared = Task(function.__name__, function, space(over), tuple(arguments), params, returns, along, is_origin, where)
    _refuse_bad_traversal(declared, place)
    if asks_index and not over:
        raise GraphError(f"{place}: asks for its index, but runs once and has none; say over what it runs")
    return replace(declared, asks_index=asks_index, block=declared.name, sets=declared.params)


def _block(task: Task[..., Any], block: str | type[Params] | None, place: str) -> dict[str, Any]:
    """The block that sets a task, and all parameters of its own one."""
    if isinstance(block, type):
        if task.params is not None and not issubclass(block, task.params):
            raise GraphError(f"{place}: its block is set by {block.__name__}, which does not extend {task.params.__name__}")
        return {"block": task.name, "sets": block}
    if block is not None and task.params is None:
        raise GraphError(f"{place}: is set by the block {block}, but takes no params")
    return {"block": block or task.name, "sets": task.params if block in (None, task.name) else None}


def _refuse_bad_traversal(task: Task[..., Any], place: str) -> None:
    if any(a.previous for a in task.arguments) != (task.along is not None):
        raise GraphError(f"{place}: a task reads at the previous member exactly if it says along which traversal")
    if task.along is not None and not task.over:
        raise GraphError(f"{place}: goes along {task.along.__name__}, but runs once; say over what it runs")
    if task.along is not None and task.traversed not in task.over:
        raise GraphError(
            f"{place}: goes along {task.along.__name__}, which orders {task.along.orders}, but runs over {'/'.join(task.over)}"
        )
