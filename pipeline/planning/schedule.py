"""Which nodes there are, which are fresh, which are stale and why, and which may run next.

A schedule is laid out as far as it is known: where a fan-out depends on data that is not there yet (the intervals of a
sequence), its nodes appear when that data does, so that running is a fixpoint of laying out and completing. Planning is a
schedule nobody completes; it computes nothing.
"""

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from types import MappingProxyType

from kinetree.errors import DamagedArtifactError
from kinetree.pipeline.graph import AnyTask, Graph
from kinetree.pipeline.node import Node, label
from kinetree.pipeline.planning.damage import MENDS, discard_damaged, is_mended, makers_of
from kinetree.pipeline.planning.dependents import Dependents
from kinetree.pipeline.planning.entry import DONE, Entry, Loss, State
from kinetree.pipeline.planning.freshness import Freshness
from kinetree.pipeline.planning.layout import Layout, OriginArtifacts, T
from kinetree.pipeline.planning.made_with import EVERY_VERSION_TRUSTED, MadeWith
from kinetree.pipeline.planning.origin import Links, accepted
from kinetree.pipeline.planning.ready import ReadyNodes
from kinetree.pipeline.planning.reason import Reason, Recall
from kinetree.pipeline.planning.together import together
from kinetree.pipeline.storage.store import Record, Store
from kinetree.schemas.array import Artifact, Params


class Schedule:
    """The nodes of one graph over one sequence; it and its `Dependents` alone change their entries.

    A run takes nodes with `ready`, sends them with `send` and tells what became of each with `complete`, `fail`, `put_back`
    or `mend`.
    """

    def __init__(
        self,
        graph: Graph,
        params: Mapping[str, Params],
        store: Store,
        origin_artifacts: OriginArtifacts,
        *,
        force: Iterable[str] = (),
        recall: Recall = lambda _: "nothing",
        distrusted: MadeWith = EVERY_VERSION_TRUSTED,
        links: Links = MappingProxyType({}),
    ) -> None:
        self.graph, self.store = graph, store
        self.origin_artifacts, self.links = origin_artifacts, links
        self.freshness = Freshness(graph, params, store, frozenset(force), recall, distrusted)
        self.entries: dict[Node, Entry] = {}
        self._layout = Layout(graph, origin_artifacts, self._ask, self.entries.__contains__)
        self._unlisted: dict[Node, None] = {}
        self._dependents = Dependents(self.entries, self._unlisted)
        self._ready = ReadyNodes(graph, self.entries)
        self._values: dict[Node, Artifact] = {}
        self._shaping = {t.name for t in graph.openers.values()} | {
            graph.writers[artifact].name for t in graph.tasks for artifact in (t.along, t.among) if artifact
        }
        self.blocked: dict[str, tuple[Node, ...]] = {}
        self._losses: list[Loss] = []
        self._skipped_late: list[Node] = []
        self.lay_out()
        self.freshness.holder = store  # from now on others write
        self._losses.clear()  # nothing was told of these nodes yet

    def lay_out(self) -> list[Node]:
        """Adds every node whose index is known by now, links every node whose inputs are; returns what is fresh at once."""
        fresh: list[Node] = []
        for task in self.graph.tasks:
            if task.is_origin:
                for entry in accepted(task, self.links, self.origin_artifacts, self.entries):
                    self.entries[entry.node] = entry
                continue
            for each in (task, *self.graph.behind(task)):  # what is read at a previous member may come later in the graph
                self._list(each)
            unlisted = [n for n in self._unlisted if n.task == task.name]
            for node in unlisted:
                self._link(self.entries[node])
            fresh += self._settle_all(n for n in unlisted if n not in self._unlisted and not self.entries[n].waits)
        return fresh

    def _list(self, task: AnyTask) -> None:
        indices, self.blocked[task.name] = self._layout.indices(task.over)
        for node in (Node(task.name, index) for index in indices):
            if node not in self.entries:
                self.entries[node] = Entry(node, task, label(node, task.over))
                self._unlisted[node] = None

    @property
    def is_idle(self) -> bool:
        """Whether everything is up to date, so that nothing has to be computed or stored."""
        return all(entry.state == "fresh" for entry in self.entries.values()) and not any(self.blocked.values())

    def ready(self) -> Iterator[Entry]:
        """Takes the stale nodes one after the other, in the order of `urgency`: a frame is finished before the next."""
        for entry in self._ready.popped():
            entry.state = "running"
            yield entry

    def deepest(self) -> float | None:
        """How deep in the graph the next ready node stands, 0 to 1; None where no node is ready."""
        return self._ready.deepest()

    def send(self, entry: Entry, *, is_alone: bool = False) -> list[Entry]:
        """A ready node runs, and unless it goes alone what travels with it as one piece of work (`together`).

        An artifact of it that was found damaged is removed first, so that it is made again.
        returns : these nodes, each after those of them that it reads
        """
        if entry.damaged is not None:
            discard_damaged(self.store, entry, entry.damaged)
            entry.damaged = None
        parcel = [entry] if is_alone else together(entry, self.graph, self.entries, self._dependents.of, self._unlisted)
        for member in parcel:
            member.state = "running"
        return parcel

    def complete(self, node: Node, key: str, artifact: str, record: Record | None, *, ran: bool) -> list[Entry]:
        """A node has its artifact: its dependents settle, what it opens is laid out; returns what turned out fresh."""
        entry = self.entries[node]
        entry.key, entry.artifact, entry.record = key, artifact, record
        entry.state = "ran" if ran else "fresh"
        fresh = self._settle_all(self._dependents.released(node))
        if self._shaping & {node.task, *(n.task for n in fresh)}:
            fresh += self.lay_out()
        return [self.entries[n] for n in fresh if self.entries[n].state == "fresh"]

    def fail(self, node: Node, cause: str) -> list[Node]:
        """A node failed: everything that waits for it is skipped; returns what was."""
        self.entries[node].state, self.entries[node].cause = "failed", cause
        return self._dependents.skip_below(node)

    def put_back(self, node: Node) -> None:
        """A node that was sent was not computed, since one it travelled with was not: it waits for that one again."""
        if self.entries[node].state == "running":  # and not skipped by now
            self.entries[node].state = "waits"

    def mend(self, node: Node, artifact: str, what: str) -> list[tuple[Entry, State]] | None:
        """A node could not read an input: whoever made it makes it again, and the node waits for that.

        artifact : digest of the input; what : what is wrong with it
        returns  : the nodes that are to run again, and what each was; None where that cannot be or was too often
        raises   : StoreError where no node makes it
        """
        entry = self.entries[node]
        makers = makers_of(self.entries, entry, artifact, what)
        if not makers:
            self.store.discard(artifact)  # another graph makes it
            return None
        if entry.state == "skipped":
            return []
        redone = [(self.entries[n], self.entries[n].state) for n in makers if self.entries[n].state in DONE]
        if is_mended(self.store, entry, [maker for maker, _ in redone], artifact):
            entry.is_late = True
            makers, redone = [n for n in makers if self.entries[n].state not in DONE], []
        if any(maker.redone >= MENDS for maker, _ in redone):
            return None
        for maker, _ in redone:
            self._redo(maker.node, what)
        entry.state = "waits"
        self._dependents.wait_also(entry, makers)
        if not makers:
            entry.state = "stale"
            self._ready.add(node)
        return redone

    def _redo(self, node: Node, what: str) -> None:
        """A node's artifact turned out to be damaged: it runs again, and what was to read it waits for it again."""
        entry = self.entries[node]
        entry.redone += 1
        self._values.pop(node, None)
        entry.state, entry.reasons, entry.damaged = "stale", (Reason("artifact", what),), entry.artifact
        self._ready.add(node)

    def value(self, node: Node) -> Artifact:
        """The artifact of a node that has one, arrays read lazily."""
        entry = self.entries[node]
        if entry.task.is_origin and not entry.task.is_linked:
            return self.origin_artifacts[node.task][node.at]
        if entry.artifact is None:
            raise KeyError(node)
        if node not in self._values:
            self._values[node] = self.store.read(entry.task.returns, entry.artifact)
        return self._values[node]

    def dependents(self, node: Node) -> Sequence[Node]:
        """The nodes that read this one or are laid out by it."""
        return self._dependents.of(node)

    def _ask(self, node: Node, question: Callable[[Artifact], T]) -> T | None:
        """What an opener or a traversal answers, None while it is not there (or no longer readable)."""
        entry = self.entries.get(node)
        if entry is None or entry.state not in DONE:
            return None
        try:
            return question(self.value(node))
        except DamagedArtifactError as error:
            self.lose(entry, error.what)
            return None

    def lose(self, entry: Entry, what: str) -> None:
        """The artifact of a node that was done is not there any more: it runs again, or fails where it did too often."""
        was, gives_up = entry.state, entry.redone >= MENDS
        if not gives_up:
            self._redo(entry.node, what)
        self._losses.append(Loss(entry, was, what, tuple(self.fail(entry.node, what)) if gives_up else None))

    def losses(self) -> list[Loss]:
        """What was lost since this was asked last, in that order."""
        losses, self._losses = self._losses, []
        return losses

    def skipped_late(self) -> list[Entry]:
        """What was skipped as soon as it was laid out since this was asked last: a node that it reads had failed before."""
        skipped, self._skipped_late = self._skipped_late, []
        return [self.entries[node] for node in skipped]

    def _link(self, entry: Entry) -> None:
        """Lists what a node reads; while that cannot be known, it waits for the nodes that will tell."""
        inputs, blocking = self._layout.inputs(entry.task, entry.node.at)
        wanted = blocking or [node for _, nodes in inputs for node in nodes]
        self._dependents.wait(entry, wanted)
        if not blocking:
            self._layout.refuse_missing(entry.task, entry.label, wanted)
            entry.inputs = inputs
            del self._unlisted[entry.node]
        self._skipped_late += self._dependents.skipped_late(entry, wanted)

    def _settle_all(self, nodes: Iterable[Node]) -> list[Node]:
        """Settles nodes whose inputs are all there, and on from those that turn out fresh; returns these."""
        fresh: list[Node] = []
        queue = deque(nodes)
        while queue:
            node = queue.popleft()
            if self.entries[node].state == "waits" and self._settle(self.entries[node]):
                fresh.append(node)
                queue.extend(self._dependents.released(node))
        return fresh

    def _settle(self, entry: Entry) -> bool:
        """Computes a node's key and asks the store; True where the node is fresh."""
        entry.key, record, reasons = self.freshness.judged(entry, self.entries)
        if record is not None:
            entry.state, entry.artifact, entry.record = "fresh", record.artifact, record
            return True
        entry.state, entry.reasons = "stale", reasons
        self._ready.add(entry.node)
        return False
