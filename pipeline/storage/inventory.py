"""What a store holds at one moment, for who asks of every node of a graph.

A folder answers one question in microseconds. A service at the end of a network answers in tens of milliseconds, but lists a
thousand objects in one answer: its artifacts are listed, and what lies in records of their own is read side by side.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

from kinetree.pipeline.storage.place import Listed
from kinetree.pipeline.storage.records import Record
from kinetree.pipeline.storage.store import ARTIFACTS, Store, artifact_path


class Holder(Protocol):
    """Whoever knows which keys have records and which artifacts are there."""

    def record(self, key: str) -> Record | None:
        """What `key` made; None where it made nothing yet or the record cannot be read."""

    def holds(self, record: Record) -> bool:
        """Whether the record's artifact lies there in its size."""


@dataclass(frozen=True)
class Inventory:
    """A store as it was when it was first asked; what is written later is not in it."""

    store: Store

    def record(self, key: str) -> Record | None:
        """What `key` had made; None where it had made nothing or the record cannot be read."""
        return self._singles.get(key) or self.store.record(key, as_listed=True)

    def holds(self, record: Record) -> bool:
        """Whether the record's artifact lay there in its size."""
        listed = self._artifacts.get(artifact_path(record.artifact).removeprefix(f"{ARTIFACTS}/"))
        return listed is not None and listed.size == record.bytes

    @cached_property
    def _artifacts(self) -> dict[str, Listed]:
        return self.store.place.listed(ARTIFACTS)

    @cached_property
    def _singles(self) -> dict[str, Record]:
        return self.store.records.singles()


def inventory(store: Store) -> Holder:
    """Whom to ask of many nodes at once: the store itself where a question costs next to nothing."""
    return Inventory(store) if store.place.is_remote else store
