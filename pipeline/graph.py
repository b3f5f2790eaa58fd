"""The graph of tasks as their signatures draw it (`edges.py`), in an order in which it can run.

Everything here is about types; nothing knows which frames or intervals exist. A graph that cannot work is refused when it
is made, which is when `kinetree.tasks` is imported.
"""

import contextlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

from kinetree.errors import CycleError, GraphError, MissingWriterError, TwoWritersError
from kinetree.pipeline.edges import AnyTask as AnyTask
from kinetree.pipeline.edges import Edges, lists_members
from kinetree.pipeline.identity.own_code import code_parts, keep_code
from kinetree.pipeline.task import Space, space
from kinetree.schemas.array import Artifact, Params

if TYPE_CHECKING:  # a graph that is kept in order does without
    import networkx as nx

ASIDE = 2
"""A task is aside where the longest way through it is shorter by more tasks than this than the longest of all."""


@dataclass(frozen=True)
class Graph(Edges):
    """Tasks in an order in which each comes after what it reads."""

    @staticmethod
    def of(tasks: Iterable[AnyTask]) -> "Graph":
        """The graph of these tasks.

        raises : TwoWritersError, MissingWriterError, CycleError, GraphError; each names the places in the code
        """
        unordered = Graph(tuple(tasks))
        _one_writer_each(unordered.tasks)
        _every_edge_has_a_writer(unordered)
        _every_space_is_opened_once(unordered)
        _blocks_are_those_of_tasks(unordered)
        ordered = Graph(_ordered(unordered))
        for task in ordered.tasks:
            for argument in task.arguments:
                ordered.gathered_space(task, argument)
            _traversal_is_ordered_at_its_index(ordered, task)
            _selection_is_known_at_its_index(ordered, task)
        ordered.remember_code()
        return ordered

    @cached_property
    def unasked(self) -> tuple[str, ...]:
        """Names of the tasks that run without being named."""
        return tuple(task.name for task in self.tasks if not task.on_request)

    @cached_property
    def aside(self) -> frozenset[str]:
        """Names of the tasks that little waits for, so that they can go last."""
        until: dict[str, int] = {}
        beyond = dict.fromkeys(self.by_name, 0)
        for task in self.tasks:
            until[task.name] = max((until[read.name] + 1 for read in self.before(task)), default=0)
        for task in reversed(self.tasks):
            for read in self.before(task):
                beyond[read.name] = max(beyond[read.name], beyond[task.name] + 1)
        ways = {name: until[name] + beyond[name] for name in until}
        return frozenset(name for name, way in ways.items() if way + ASIDE < max(ways.values()))

    def until(self, names: Sequence[str]) -> "Graph":
        """The graph that is needed to run the named tasks and no more."""
        needed: set[str] = set()
        waiting = [self.task(name) for name in names]
        while waiting:
            task = waiting.pop()
            if task.name not in needed:
                needed.add(task.name)
                waiting.extend(self.reads(task))
        return replace(self, tasks=tuple(task for task in self.tasks if task.name in needed))

    def remember_code(self) -> None:
        """Digests the code now, while what lies there is what was loaded: a process that lives on while its source is
        edited must not pass the old code's results off as the new code's.
        """
        for task in self.tasks:
            with contextlib.suppress(ImportError, ValueError):  # tasks typed at a prompt can be drawn, not run
                code_parts(task.module, task.name)
        keep_code()

    def networkx(self) -> "nx.DiGraph[str]":
        """Task names as nodes (with over, artifact, params, paper, summary), edges with argument, form and previous.

        An edge is `previous` where the artifact is read at the previous member alone.
        """
        import networkx as nx

        drawn: nx.DiGraph[str] = nx.DiGraph()
        for task in self.tasks:
            drawn.add_node(
                task.name,
                over="/".join(task.over),
                artifact=task.returns.__name__,
                params=task.params.__name__ if task.params else None,
                paper=task.paper,
                summary=task.summary,
            )
        for task in self.tasks:
            for a in task.arguments:
                edge = (self.writers[a.artifact].name, task.name)
                if not (a.previous and drawn.has_edge(*edge)):
                    drawn.add_edge(*edge, argument=a.name, form=a.form, previous=a.previous)
        return drawn


def _one_writer_each(tasks: Sequence[AnyTask]) -> None:
    writers: dict[type[Artifact], AnyTask] = {}
    names: dict[str, AnyTask] = {}
    for task in tasks:
        writer = writers.setdefault(task.returns, task)
        if writer is not task:
            raise TwoWritersError(f"two tasks write {task.returns.__name__}: {writer.where} and {task.where}")
        namesake = names.setdefault(task.name, task)
        if namesake is not task:
            raise TwoWritersError(f"two tasks are named {task.name}: {namesake.where} and {task.where}")


def _every_edge_has_a_writer(graph: Graph) -> None:
    for task in graph.tasks:
        own = next((a.name for a in task.arguments if a.artifact is task.returns and not a.previous), None)
        if own is not None or task.along is task.returns:
            what = f"argument {own}" if own else "the traversal it goes along"
            raise CycleError(
                f"{task.name} ({task.where}) waits for itself: {what} is {task.returns.__name__}, which it writes; for its"
                f" artifact at the previous member write {task.returns.__name__} | None and say along which other artifact"
            )
        wanted = [(f"argument {a.name}", a.artifact) for a in task.arguments]
        wanted += [("the traversal it goes along", task.along)] if task.along else []
        wanted += [("the selection it gathers among", task.among)] if task.among else []
        for what, artifact in wanted:
            if artifact not in graph.writers:
                raise MissingWriterError(
                    f"{task.name} ({task.where}): {what} is {artifact.__name__} ({artifact.__module__}), which no task writes"
                )


def _blocks_are_those_of_tasks(graph: Graph) -> None:
    for task in graph.tasks:
        if task.params is not None and not _sets(graph.by_name.get(task.block), task.params):
            raise GraphError(
                f"{task.name} ({task.where}): is set by the block {task.block}, but there is no task of that name"
                f" with {task.params.__name__}"
            )


def _sets(owner: AnyTask | None, params: type[Params]) -> bool:
    """Whether the block of that name is this task's own and has all fields of the params."""
    return owner is not None and owner.sets is not None and issubclass(owner.sets, params)


def _every_space_is_opened_once(graph: Graph) -> None:
    opener: dict[Space, AnyTask] = {}
    for task in graph.tasks:
        opened = [space(path) for path in task.returns.opens] + ([task.over] if lists_members(task) else [])
        for path in opened:
            if not set(task.over) <= set(path[: None if task.is_origin else -1]):
                raise GraphError(f"{task.name} ({task.where}) runs over {'/'.join(task.over)} and cannot open {'/'.join(path)}")
            if path in opener:
                raise TwoWritersError(f"two tasks open {'/'.join(path)}: {opener[path].where} and {task.where}")
            opener[path] = task
    for task in graph.tasks:
        for depth in range(1, len(task.over) + 1):
            if task.over[:depth] not in opener:
                raise MissingWriterError(
                    f"{task.name} ({task.where}) runs over {'/'.join(task.over)}, but no task opens"
                    f" {'/'.join(task.over[:depth])}"
                )


def _traversal_is_ordered_at_its_index(graph: Graph, task: AnyTask) -> None:
    if task.along is not None and not set(graph.writers[task.along].over) <= set(task.over):
        orderer = graph.writers[task.along]
        raise GraphError(
            f"{task.name} ({task.where}) goes along {task.along.__name__}, but {orderer.name} ({orderer.where}) writes one per"
            f" {'/'.join(orderer.over)}"
        )


def _selection_is_known_at_its_index(graph: Graph, task: AnyTask) -> None:
    """A selection is told at the task's own index, of a dimension that the task gathers over."""
    if task.among is None:
        return
    selector, place = graph.writers[task.among], f"{task.name} ({task.where}) is among {task.among.__name__}"
    if not set(selector.over) <= set(task.over):
        raise GraphError(f"{place}, but {selector.name} ({selector.where}) writes one per {'/'.join(selector.over)}")
    gathered = {d for a in task.arguments if a.form != "one" for d in graph.gathered_space(task, a)} - set(task.over)
    if task.among.selects not in gathered:
        raise GraphError(f"{place}, which selects {task.among.selects}, but gathers over no {task.among.selects}")


def _ordered(graph: Graph) -> tuple[AnyTask, ...]:
    """Topological order, ties in the order of declaration."""
    import networkx as nx

    edges: nx.DiGraph[str] = nx.DiGraph()
    edges.add_nodes_from(task.name for task in graph.tasks)
    edges.add_edges_from((read.name, task.name) for task in graph.tasks for read in graph.before(task))
    rank = {task.name: n for n, task in enumerate(graph.tasks)}
    if not nx.is_directed_acyclic_graph(edges):
        ring = [edge[0] for edge in nx.find_cycle(edges)]
        places = " → ".join(f"{name} ({graph.by_name[name].where})" for name in [*ring, ring[0]])
        raise CycleError(f"tasks wait for each other: {places}")
    in_order: Any = nx.lexicographical_topological_sort
    return tuple(graph.by_name[name] for name in in_order(edges, key=rank.__getitem__))
