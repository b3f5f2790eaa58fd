"""Which nodes there are, which are fresh, which are stale and why, and which may run next.

A schedule is laid out as far as it is known: where a fan-out depends on data that is not there yet (the intervals of a
sequence), its nodes appear when that data does, so that running is a fixpoint of laying out and completing. Planning is a
schedule nobody completes; it computes nothing.
"""

import heapq
from collections import Counter, defaultdict, deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

from kinetree.pipeline.errors import DamagedArtifactError, GraphError
from kinetree.pipeline.graph import AnyTask, Graph
from kinetree.pipeline.key import artifact_digest, code_digest, code_parts, node_key
from kinetree.pipeline.layout import Given, Layout, T
from kinetree.pipeline.node import Node, label
from kinetree.pipeline.reason import Reason, Recall, Work, differences, never_ran
from kinetree.pipeline.store import Record, Store
from kinetree.pipeline.task import Argument
from kinetree.schemas.array import Artifact, Index, Params

State = Literal["waits", "stale", "running", "fresh", "ran", "failed", "skipped"]
DONE: tuple[State, ...] = ("fresh", "ran")


@dataclass
class Entry:
    """One node of the schedule and what is known of it."""

    node: Node
    task: AnyTask
    label: str
    state: State = "waits"
    inputs: tuple[tuple[Argument, tuple[Node, ...]], ...] | None = None
    """Per argument the nodes it reads; None while the members of a fan-out are not known."""
    waits: set[Node] = field(default_factory=set)
    reasons: tuple[Reason, ...] = ()
    key: str | None = None
    artifact: str | None = None
    record: Record | None = None
    damaged: str | None = None
    """Digest of an artifact that was found damaged and has to go before it is made again."""
    mends: Counter[str] = field(default_factory=Counter)
    """How often each input of this node, by its digest, had to be computed again."""
    cause: str = ""
    """What failed, for a failed node; which node failed, for a skipped one."""


class Schedule:
    """The nodes of one graph over one sequence; `complete`, `fail` and `redo` are how a run tells it what happened."""

    def __init__(
        self,
        graph: Graph,
        params: Mapping[str, Params],
        store: Store,
        given: Given,
        *,
        force: Iterable[str] = (),
        recall: Recall = lambda _: "nothing",
    ) -> None:
        self.graph = graph
        self.params = {name: p.model_dump(mode="json") for name, p in params.items()}
        self.store = store
        self.given = given
        self.force = frozenset(force)
        self.recall = recall
        self.entries: dict[Node, Entry] = {}
        self._layout = Layout(graph, given, self._ask, self.entries.__contains__)
        self.code = {task.name: code_digest(task.module, task.name) for task in graph.tasks}
        self._rank = {task.name: n for n, task in enumerate(graph.tasks)}
        self._dependents: defaultdict[Node, dict[Node, None]] = defaultdict(dict)
        self._unlisted: dict[Node, None] = {}
        self._ready: list[tuple[int, Index, Node]] = []
        self._values: dict[Node, Artifact] = {}
        self._shaping = {t.name for t in graph.openers.values()} | {
            graph.writers[t.along].name for t in graph.tasks if t.along
        }
        self.blocked: dict[str, tuple[Node, ...]] = {}
        self.lay_out()

    def lay_out(self) -> list[Node]:
        """Adds every node whose index is known by now, links every node whose inputs are; returns what is fresh at once."""
        fresh: list[Node] = []
        for task in self.graph.tasks:
            if task.is_origin:
                self._accept(task)
                continue
            indices, blocking = self._layout.indices(task.over)
            self.blocked[task.name] = blocking
            for node in (Node(task.name, index) for index in indices):
                if node not in self.entries:
                    self.entries[node] = Entry(node, task, label(node, task.over))
                    self._unlisted[node] = None
            unlisted = [n for n in self._unlisted if n.task == task.name]
            for node in unlisted:
                self._link(self.entries[node])
            fresh += self._settle_all(n for n in unlisted if n not in self._unlisted and not self.entries[n].waits)
        return fresh

    def ready(self) -> Iterator[Entry]:
        """Takes the stale nodes one after the other, deepest task first, so that a frame is finished before the next."""
        while self._ready:
            entry = self.entries[heapq.heappop(self._ready)[2]]
            if entry.state == "stale":
                entry.state = "running"
                yield entry

    def travelling_with(self, entry: Entry) -> list[Entry]:
        """The node and all nodes of the same index that need nothing else: they travel as one piece of work."""
        parcel = [entry]
        inside = {entry.node}
        for member in parcel:
            if not entry.node.at:
                break
            for node in self._dependents[member.node]:
                other = self.entries[node]
                if other.state == "waits" and node not in inside and node.at == entry.node.at:
                    if node not in self._unlisted and other.waits <= inside:
                        inside.add(node)
                        parcel.append(other)
        parcel.sort(key=lambda e: self._rank[e.node.task])
        for member in parcel:
            member.state = "running"
        return parcel

    def complete(self, node: Node, key: str, artifact: str, record: Record | None, *, ran: bool) -> list[Entry]:
        """A node has its artifact: its dependents settle, what it opens is laid out; returns what turned out fresh."""
        entry = self.entries[node]
        entry.key, entry.artifact, entry.record = key, artifact, record
        entry.state = "ran" if ran else "fresh"
        fresh = self._settle_all(self._released(node))
        if self._shaping & {node.task, *(n.task for n in fresh)}:
            fresh += self.lay_out()
        return [self.entries[n] for n in fresh if self.entries[n].state == "fresh"]

    def fail(self, node: Node, cause: str) -> list[Node]:
        """A node failed: everything that waits for it is skipped; returns what was."""
        self.entries[node].state, self.entries[node].cause = "failed", cause
        return self._skip_below(node)

    def _skip_below(self, node: Node) -> list[Node]:
        skipped: list[Node] = []
        queue = deque([node])
        while queue:
            for dependent in self._dependents[queue.popleft()]:
                entry = self.entries[dependent]
                if entry.state not in ("skipped", "failed"):
                    entry.state, entry.cause = "skipped", self._failure(node)
                    skipped.append(dependent)
                    queue.append(dependent)
        return skipped

    def redo(self, node: Node, what: str) -> None:
        """A node's artifact turned out to be damaged: it runs again, and what was to read it waits for it again."""
        entry = self.entries[node]
        self._values.pop(node, None)
        entry.state, entry.reasons, entry.damaged = "stale", (Reason("artifact", what),), entry.artifact
        heapq.heappush(self._ready, (-self._rank[node.task], node.at, node))

    def wait_again(self, node: Node, on: Node) -> None:
        """A node could not read an input; it waits for it once more."""
        entry = self.entries[node]
        entry.state = "waits"
        entry.waits.add(on)
        self._dependents[on][node] = None

    def holding(self, artifact: str) -> list[Node]:
        """The nodes whose artifact has this digest."""
        return [node for node, entry in self.entries.items() if entry.artifact == artifact and not entry.task.is_origin]

    def value(self, node: Node) -> Artifact:
        """The artifact of a node that has one, arrays read lazily."""
        entry = self.entries[node]
        if entry.task.is_origin:
            return self.given[node.task][node.at]
        if entry.artifact is None:
            raise KeyError(node)
        if node not in self._values:
            self._values[node] = self.store.read(entry.task.returns, entry.artifact)
        return self._values[node]

    def work(self, entry: Entry) -> Work:
        """All that decides what a node with known inputs computes."""
        inputs = [
            {
                "argument": argument.name,
                "form": argument.form,
                "nodes": [self.entries[n].label for n in nodes],
                "artifacts": [self.entries[n].artifact for n in nodes],
            }
            for argument, nodes in entry.inputs or ()
        ]
        return Work(self.params.get(entry.node.task, {}), code_parts(entry.task.module, entry.task.name), inputs)

    def dependents(self, node: Node) -> Sequence[Node]:
        """The nodes that read this one or are laid out by it."""
        return tuple(self._dependents[node])

    def _accept(self, task: AnyTask) -> None:
        for index, artifact in self.given.get(task.name, {}).items():
            node = Node(task.name, index)
            if node not in self.entries:
                entry = Entry(node, task, label(node, task.over), state="fresh", inputs=())
                entry.artifact = artifact_digest(artifact)
                self.entries[node] = entry

    def _ask(self, node: Node, question: Callable[[Artifact], T]) -> T | None:
        """What an opener or a traversal answers, None while it is not there (or no longer readable)."""
        entry = self.entries.get(node)
        if entry is None or entry.state not in DONE:
            return None
        try:
            return question(self.value(node))
        except DamagedArtifactError as error:
            self.redo(node, error.what)
            return None

    def _link(self, entry: Entry) -> None:
        """Lists what a node reads; while that cannot be known, it waits for the nodes that will tell."""
        blocking: list[Node] = []
        inputs: list[tuple[Argument, tuple[Node, ...]]] = []
        for argument in entry.task.arguments:
            nodes, blocked = self._layout.reads(entry.task, entry.node.at, argument)
            inputs.append((argument, nodes))
            blocking.extend(blocked)
        wanted = blocking or [node for _, nodes in inputs for node in nodes]
        entry.waits = {n for n in wanted if n not in self.entries or self.entries[n].state not in DONE}
        for node in wanted:
            self._dependents[node][entry.node] = None
        if not blocking:
            self._refuse_missing(entry, wanted)
            entry.inputs = tuple(inputs)
            del self._unlisted[entry.node]
        failed = next((n for n in wanted if n in self.entries and self.entries[n].state in ("failed", "skipped")), None)
        if failed is not None and entry.state != "skipped":
            entry.state, entry.cause = "skipped", self._failure(failed)
            self._skip_below(entry.node)

    def _failure(self, node: Node) -> str:
        """The label of the node whose failure is why `node` did not run."""
        entry = self.entries[node]
        return entry.cause if entry.state == "skipped" else entry.label

    def _refuse_missing(self, entry: Entry, wanted: Sequence[Node]) -> None:
        for node in wanted:
            if node not in self.entries:
                name = label(node, self.graph.by_name[node.task].over)
                raise GraphError(f"{entry.label} ({entry.task.where}) reads {name}, which does not exist")

    def _settle_all(self, nodes: Iterable[Node]) -> list[Node]:
        """Settles nodes whose inputs are all there, and on from those that turn out fresh; returns these."""
        fresh: list[Node] = []
        queue = deque(nodes)
        while queue:
            node = queue.popleft()
            if self.entries[node].state == "waits" and self._settle(self.entries[node]):
                fresh.append(node)
                queue.extend(self._released(node))
        return fresh

    def _released(self, node: Node) -> list[Node]:
        """The dependents that waited for nothing but this node."""
        released = []
        for dependent in self._dependents[node]:
            entry = self.entries[dependent]
            entry.waits.discard(node)
            if not entry.waits and dependent not in self._unlisted and entry.state == "waits":
                released.append(dependent)
        return released

    def _settle(self, entry: Entry) -> bool:
        """Computes a node's key and asks the store; True where the node is fresh."""
        work = self.work(entry)
        entry.key = node_key(
            entry.node.task, self.code[entry.node.task], work.params, key_inputs(entry.inputs or (), work.inputs)
        )
        record = self.store.record(entry.key)
        if record is not None and entry.node.task not in self.force and self.store.holds(record):
            entry.state, entry.artifact, entry.record = "fresh", record.artifact, record
            return True
        entry.state, entry.reasons = "stale", self._reasons(entry, work, record)
        heapq.heappush(self._ready, (-self._rank[entry.node.task], entry.node.at, entry.node))
        return False

    def _reasons(self, entry: Entry, work: Work, record: Record | None) -> tuple[Reason, ...]:
        if record is not None and not self.store.holds(record):
            return (Reason("artifact", "missing or damaged"),)
        if entry.node.task in self.force:
            return (Reason("forced"),)
        then = self.recall(entry.label)
        if then == "nothing":
            return (never_ran(),)
        if then == "lost":
            return (Reason("artifact", "its record is missing or damaged"),)
        return differences(work, then) or (Reason("artifact", "its record is missing or damaged"),)


def key_inputs(inputs: Sequence[tuple[Argument, Sequence[Node]]], told: Sequence[Mapping[str, Any]]) -> list[Any]:
    """What of its inputs goes into a node's key: artifacts in order, and member numbers where the task can see them."""
    return [
        [a.name, a.form, list(t["artifacts"]), [n.at[-1] for n in nodes] if a.form == "mapping" else None]
        for (a, nodes), t in zip(inputs, told, strict=True)
    ]
