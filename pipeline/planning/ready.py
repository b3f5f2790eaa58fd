"""The nodes that may run now: those of chains first, then the deepest, so that a frame is finished before the next is begun."""

import heapq
from collections.abc import Iterator, Mapping

from kinetree.pipeline.graph import Graph
from kinetree.pipeline.node import Node
from kinetree.pipeline.planning.entry import Entry
from kinetree.schemas.array import Index


class ReadyNodes:
    """Stale nodes that wait for nothing, by how deep their tasks stand in the graph.

    What goes from one member to the next goes first, since the rest of its chain waits for it; what little waits for goes last.
    """

    def __init__(self, graph: Graph, entries: Mapping[Node, Entry]) -> None:
        self._entries = entries
        self._rank = {task.name: n for n, task in enumerate(graph.tasks)}
        chains = {task.name for task in graph.tasks if task.is_chain}
        sides = {name: -1 if name in graph.aside else int(name in chains) for name in self._rank}
        self._depth = {name: n + len(graph.tasks) * sides[name] for name, n in self._rank.items()}
        self._waiting: list[tuple[int, Index, Node]] = []

    def add(self, node: Node) -> None:
        """A node may run."""
        heapq.heappush(self._waiting, (-self._depth[node.task], node.at, node))

    def taken(self) -> Iterator[Entry]:
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
