"""Which nodes wait for which: they are ready when these are done, and skipped when one of these failed."""

from collections import defaultdict, deque
from collections.abc import Collection, Iterable, Mapping

from kinetree.pipeline.node import Node
from kinetree.pipeline.planning.entry import DONE, Entry


class Dependents:
    """By node, those that read it or are laid out by it; the entries are those of a schedule.

    unlisted : nodes of which it is not known yet what they read
    """

    def __init__(self, entries: Mapping[Node, Entry], unlisted: Collection[Node]) -> None:
        self._entries, self._unlisted = entries, unlisted
        self._by_node: defaultdict[Node, dict[Node, None]] = defaultdict(dict)
        """In the order in which they were linked."""

    def wait(self, entry: Entry, nodes: Iterable[Node]) -> None:
        """A node waits for those of these nodes that are not done."""
        wanted = list(nodes)
        entry.waits = {n for n in wanted if n not in self._entries or self._entries[n].state not in DONE}
        for node in wanted:
            self._by_node[node][entry.node] = None

    def wait_also(self, entry: Entry, nodes: Collection[Node]) -> None:
        """A node waits for these nodes beside what it waits for already."""
        entry.waits.update(nodes)
        for node in nodes:
            self._by_node[node][entry.node] = None

    def of(self, node: Node) -> tuple[Node, ...]:
        """Those that read this node or are laid out by it."""
        return tuple(self._by_node.get(node, ()))

    def released(self, node: Node) -> list[Node]:
        """The dependents that waited for nothing but this node, which is done."""
        released = []
        for dependent in self._by_node[node]:
            entry = self._entries[dependent]
            entry.waits.discard(node)
            if not entry.waits and dependent not in self._unlisted and entry.state == "waits":
                released.append(dependent)
        return released

    def skip_below(self, node: Node) -> list[Node]:
        """Skips everything that waits for a node that failed or was skipped; returns what was."""
        skipped: list[Node] = []
        queue = deque([node])
        while queue:
            for dependent in self._by_node[queue.popleft()]:
                entry = self._entries[dependent]
                if entry.state not in ("skipped", "failed"):
                    entry.state, entry.cause = "skipped", self._failure(node)
                    skipped.append(dependent)
                    queue.append(dependent)
        return skipped

    def skipped_late(self, entry: Entry, nodes: Iterable[Node]) -> list[Node]:
        """Skips a node, and what waits for it, where one of those that it reads had failed before; returns what was."""
        failed = next((n for n in nodes if n in self._entries and self._entries[n].state in ("failed", "skipped")), None)
        if failed is None or entry.state == "skipped":
            return []
        entry.state, entry.cause = "skipped", self._failure(failed)
        return [entry.node, *self.skip_below(entry.node)]

    def _failure(self, node: Node) -> str:
        """The label of the node whose failure is why `node` did not run."""
        entry = self._entries[node]
        return entry.cause if entry.state == "skipped" else entry.label
