"""Which nodes there are and what they read, as far as the artifacts that open spaces and order traversals are known."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Protocol, TypeVar

from kinetree.errors import GraphError
from kinetree.pipeline.graph import AnyTask, Graph
from kinetree.pipeline.node import Node, label, project
from kinetree.pipeline.signature import Argument
from kinetree.pipeline.task import Space
from kinetree.schemas.array import Artifact, Index

T = TypeVar("T")
EVERYWHERE: Mapping[str, int] = MappingProxyType({})
OriginArtifacts = Mapping[str, Mapping[Index, Artifact]]
"""What the origins found, by task name and index."""


class Ask(Protocol):
    """Puts a question to a node's artifact."""

    def __call__(self, node: Node, question: Callable[[Artifact], T], /) -> T | None:
        """The answer; None while the artifact is not there."""


@dataclass(frozen=True)
class Layout:
    """A graph over one sequence; `ask` and `exists` tell what a schedule knows by now."""

    graph: Graph
    origin_artifacts: OriginArtifacts
    ask: Ask
    exists: Callable[[Node], bool]
    _listed: dict[tuple[str, Index], tuple[Artifact, Sequence[int], frozenset[int]]] = field(default_factory=dict)
    """By space and prefix, what listed the members and what it listed: every node below is looked for among them."""

    def indices(self, space: Space, within: Mapping[str, int] = EVERYWHERE) -> tuple[list[Index], tuple[Node, ...]]:
        """The known indices of a space, and the nodes that must be computed before the rest is known.

        within : by dimension, the one member that is asked for; of other dimensions all are
        """
        known: list[Index] = [()]
        blocking: list[Node] = []
        for depth in range(1, len(space) + 1):
            longer: list[Index] = []
            for prefix in known:
                members = self._members(space[:depth], prefix, within.get(space[depth - 1]))
                if isinstance(members, Node):
                    blocking.append(members)
                else:
                    longer.extend((*prefix, member) for member in members)
            known = longer
        return known, tuple(dict.fromkeys(blocking))

    def inputs(self, task: AnyTask, index: Index) -> tuple[tuple[tuple[Argument, tuple[Node, ...]], ...], tuple[Node, ...]]:
        """What every argument of a task reads at an index, and the nodes that block saying so."""
        pairs = [(argument, *self.reads(task, index, argument)) for argument in task.arguments]
        blocking = tuple(node for _, _, blocked in pairs for node in blocked)
        return tuple((argument, nodes) for argument, nodes, _ in pairs), blocking

    def reads(self, task: AnyTask, index: Index, argument: Argument) -> tuple[tuple[Node, ...], tuple[Node, ...]]:
        """The nodes that an argument of a task reads at an index, and those that block saying so."""
        if argument.previous:
            before, blocking = self._previous(task, index)
            return ((), blocking) if before is None else self._reads(task, before, argument)
        return self._reads(task, index, argument)

    def _reads(self, task: AnyTask, index: Index, argument: Argument) -> tuple[tuple[Node, ...], tuple[Node, ...]]:
        writer = self.graph.writers[argument.artifact]
        if argument.form == "one":
            return (Node(writer.name, project(index, task.over, writer.over)),), ()
        space = self.graph.gathered_space(task, argument)
        shared = tuple(d for d in space if d in task.over)
        here = project(index, task.over, shared)
        indices, blocking = self.indices(space, dict(zip(shared, here, strict=True)))
        chosen = self._selected(task, index, indices, space)
        if isinstance(chosen, Node):
            return (), (*blocking, chosen)
        return tuple(Node(writer.name, project(i, space, writer.over)) for i in chosen), blocking

    def _selected(self, task: AnyTask, index: Index, indices: list[Index], space: Space) -> list[Index] | Node:
        """Those of the indices of a space that the task gathers among, or the node that has to tell them."""
        if task.among is None or task.among.selects not in space or task.among.selects in task.over:
            return indices
        selector = self.graph.writers[task.among]
        node = Node(selector.name, project(index, task.over, selector.over))
        members = self.ask(node, lambda value: frozenset(value.selected()))
        place = space.index(task.among.selects)
        return node if members is None else [i for i in indices if i[place] in members]

    def _members(self, space: Space, prefix: Index, only: int | None) -> Sequence[int] | Node:
        """Members of a space's last dimension below a prefix, or the node that has to tell them; `only` this one, if any."""
        opener = self.graph.openers[space]
        if opener.is_origin and opener.over == space:
            there = self.origin_artifacts[opener.name]
            if only is not None:  # asked for every node: among a thousand frames nobody looks for one
                return [only] if (*prefix, only) in there else []
            return sorted(i[-1] for i in there if i[:-1] == prefix)
        node = Node(opener.name, project(prefix, space[:-1], opener.over))
        listed = self.ask(node, lambda value: self._listed_by(value, "/".join(space), prefix))
        if listed is None:
            return node
        members, lookup = listed
        return members if only is None else [only] * (only in lookup)

    def _listed_by(self, value: Artifact, space: str, prefix: Index) -> tuple[Sequence[int], frozenset[int]]:
        """What an artifact lists below a prefix, in order and to look one up; it is asked once, however many nodes ask."""
        last = self._listed.get((space, prefix))
        if last is None or last[0] is not value:
            members = tuple(value.members(space, prefix))
            last = self._listed[space, prefix] = value, members, frozenset(members)
        return last[1], last[2]

    def refuse_missing(self, task: AnyTask, reader: str, nodes: Sequence[Node]) -> None:
        """Raises GraphError where a node, by its label, reads one that does not exist."""
        for node in nodes:
            if not self.exists(node):
                there = label(node, self.graph.by_name[node.task].over)
                raise GraphError(f"{reader} ({task.where}) reads {there}, which does not exist")

    def _previous(self, task: AnyTask, index: Index) -> tuple[Index | None, tuple[Node, ...]]:
        """The index with the previous member of the traversal, None where that starts; and the nodes that block saying so."""
        assert task.along is not None  # a declaration without it was refused
        orderer = self.graph.writers[task.along]
        node = Node(orderer.name, project(index, task.over, orderer.over))
        place = task.over.index(task.traversed)
        answer = self.ask(node, lambda order: (order.previous(index[place]),))
        if answer is None:
            return None, (node,)
        (member,) = answer
        if member is None:
            return None, ()
        before = Node(task.name, (*index[:place], member, *index[place + 1 :]))
        if not self.exists(before) and not self._members(task.over[: place + 1], index[:place], member):
            here, there = label(Node(task.name, index), task.over), label(before, task.over)
            raise GraphError(f"{here}: {task.along.__name__} puts {there} before it")
        return before.at, ()
