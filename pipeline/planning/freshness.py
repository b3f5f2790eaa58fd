"""Whether the store holds what a node would compute, and if not, why: its key, and how that differs from earlier ones."""

from collections.abc import Mapping, Sequence
from typing import Any

from kinetree.pipeline.graph import AnyTask, Graph
from kinetree.pipeline.identity.key import encoded, node_key
from kinetree.pipeline.identity.own_code import code_digest, code_parts
from kinetree.pipeline.node import Node
from kinetree.pipeline.planning.entry import Entry
from kinetree.pipeline.planning.made_with import MadeWith
from kinetree.pipeline.planning.reason import Reason, Recall, Work, differences, never_ran
from kinetree.pipeline.signature import Argument
from kinetree.pipeline.storage.inventory import Holder, inventory
from kinetree.pipeline.storage.store import Record, Store
from kinetree.schemas.array import Params

Entries = Mapping[Node, Entry]


class Freshness:
    """What decides alike about all nodes of a graph: parameters, code, what is forced or distrusted, what is stored."""

    def __init__(
        self,
        graph: Graph,
        params: Mapping[str, Params],
        store: Store,
        force: frozenset[str],
        recall: Recall,
        distrusted: MadeWith,
    ) -> None:
        self.graph = graph
        self.params = {task.name: asked_params(task, params) for task in graph.tasks}
        self.encoded = {name: encoded(asked) for name, asked in self.params.items()}
        self.code = {task.name: code_digest(task.module, task.name) for task in graph.tasks}
        self.force = force
        self.recall = recall
        self.distrusted = distrusted
        self.holder: Holder = inventory(store)
        """What is asked for records: at first a list of all that is stored, quick to ask."""

    def judged(self, entry: Entry, entries: Entries) -> tuple[str, Record | None, tuple[Reason, ...]]:
        """The key of a node whose inputs are known, its record where that is up to date, else why it is stale.

        entries : of all nodes that it reads
        """
        work = self._work(entry, entries)
        identity = [
            [a.name, a.form, list(work_input["artifacts"]), self.numbers(entry, a, nodes)]
            for (a, nodes), work_input in zip(entry.inputs or (), work.inputs, strict=True)
        ]
        index = entry.node.at if entry.task.asks_index else None
        key = node_key(entry.node.task, self.code[entry.node.task], self.encoded[entry.node.task], identity, index)
        record = self.holder.record(key)
        if record is not None and not self._asked_again(entry, record) and self.holder.holds(record):
            return key, record, ()
        return key, None, self._reasons(entry, work, record)

    def numbers(self, entry: Entry, argument: Argument, nodes: Sequence[Node]) -> tuple[int, ...] | None:
        """The member numbers by which a task sees what it gathers, None where it does not see them."""
        if argument.form != "mapping":
            return None
        place = self.graph.numbered(entry.task, argument)
        return tuple(node.at[place] for node in nodes)

    def _work(self, entry: Entry, entries: Entries) -> Work:
        """All that decides what a node with known inputs computes."""
        inputs = [
            {
                "argument": argument.name,
                "form": argument.form,
                "nodes": [entries[n].label for n in nodes],
                "artifacts": [entries[n].artifact for n in nodes],
            }
            for argument, nodes in entry.inputs or ()
        ]
        return Work(
            self.params[entry.node.task],
            code_parts(entry.task.module, entry.task.name),
            inputs,
            asked_index(entry),
        )

    def _asked_again(self, entry: Entry, record: Record) -> bool:
        """Whether somebody wants this node computed anew though its result is up to date."""
        return entry.node.task in self.force or self.distrusted(record) is not None

    def _reasons(self, entry: Entry, work: Work, record: Record | None) -> tuple[Reason, ...]:
        if record is not None and not self.holder.holds(record):
            return (Reason("artifact", "missing or damaged"),)
        if entry.node.task in self.force:
            return (Reason("forced"),)
        if record is not None and (versions := self.distrusted(record)):
            return (Reason("made with", versions),)
        then = self.recall(entry.label)
        if then == "nothing":
            return (never_ran(),)
        if then == "lost":
            return (Reason("artifact", "its record is missing or damaged"),)
        return differences(work, then) or (Reason("artifact", "its record is missing or damaged"),)


def asked_params(task: AnyTask, params: Mapping[str, Params]) -> dict[str, Any]:
    """What a task sees of its block: the fields of its own class of params."""
    if task.params is None:
        return {}
    return params[task.block].model_dump(mode="json", include=set(task.params.model_fields))


def asked_index(entry: Entry) -> dict[str, int] | None:
    """A node's index by dimension where its task asks for it, else None."""
    return dict(zip(entry.task.over, entry.node.at, strict=True)) if entry.task.asks_index else None
