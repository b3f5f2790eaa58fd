"""The nodes that may run now: the most urgent first, of these the deepest, so that a frame is done before the next is begun."""

import heapq
from collections.abc import Iterator, Mapping

from kinetree.pipeline.graph import AnyTask, Graph
from kinetree.pipeline.node import Node
from kinetree.pipeline.planning.entry import Entry
from kinetree.schemas.array import Index


def urgency(graph: Graph) -> dict[str, int]:
    """By name of a task, the greater the sooner its nodes go.

    What goes from one member to the next goes first, since the rest of its chain waits for it. What there is once for the whole
    sequence follows: it keeps one worker busy, for which the others need the many nodes of members. What little waits for goes
    last. Within each of these the deepest in the graph goes first.
    """
    return {task.name: rank + len(graph.tasks) * _class(task, graph) for rank, task in enumerate(graph.tasks)}


def _class(task: AnyTask, graph: Graph) -> int:
    if task.name in graph.aside:
        return 0
    return 3 if task.is_chain else 1 + (not task.over)


class ReadyNodes:
    """Stale nodes that wait for nothing, the most urgent first."""

    def __init__(self, graph: Graph, entries: Mapping[Node, Entry]) -> None:
        self._entries = entries
        self._rank = {task.name: n for n, task in enumerate(graph.tasks)}
        self._urgency = urgency(graph)
        self._waiting: list[tuple[int, Index, Node]] = []

    def add(self, node: Node) -> None:
        """A node may run."""
        heapq.heappush(self._waiting, (-self._urgency[node.task], node.at, node))

    def popped(self) -> Iterator[Entry]:
        """Takes the nodes one after the other; the caller says what becomes of each before it takes the next."""
        while self._waiting:
            entry = self._entries[heapq.heappop(self._waiting)[2]]
            if entry.state == "stale":
                yield entry

    def deepest(self) -> float | None:
        """How deep in the graph the next one stands, 0 to 1; None where there is none."""
        while self._waiting and self._entries[self._waiting[0][2]].state != "stale":
            heapq.heappop(self._waiting)
        return self._rank[self._waiting[0][2].task] / len(self._rank) if self._waiting else None
