"""Proof that a process computes into the store that the run reads, before its first parcel.

A worker in a container or on another machine may find another folder under the store's path. What it stores there is lost
to the run. So every process reads what the run wrote into the store, writes an answer beside it, and computes when the run
has confirmed that it read the answer.
"""

import contextlib
import functools
import os
import secrets
import socket
import time
from collections.abc import Collection
from dataclasses import dataclass

from kinetree.errors import ServiceError, StoreError
from kinetree.pipeline.storage.place import Place
from kinetree.pipeline.storage.store import Record, Store, artifact_path

SEEN_WITHIN = 60.0
"""Seconds in which what one process wrote must be there for another: a network file system may remember for so long that a
file was not there."""
ANSWER, CONFIRMED = ".answer", ".confirmed"
_proven: set[str] = set()
"""The folders of those runs whose store this process has proven to see."""


@dataclass(frozen=True)
class Sight:
    """What a run left in its store for its workers to read."""

    folder: str
    nonce: bytes
    patience: float
    """Seconds that a worker waits to be confirmed."""

    @staticmethod
    def of(store: Store) -> "Sight":
        """Writes what workers are to read; the process of the run itself needs no proof."""
        sight = Sight(f"tmp/sight-{secrets.token_hex(8)}", secrets.token_hex(16).encode(), SEEN_WITHIN)
        store.place.put(f"{sight.folder}/run", sight.nonce)
        _proven.add(sight.folder)
        return sight

    def end(self, store: Store) -> None:
        """Removes what was written."""
        _proven.discard(self.folder)
        with contextlib.suppress(StoreError):
            store.place.remove(self.folder)

    def confirm(self, store: Store) -> None:
        """In the run: confirms every process whose answer is there."""
        names = set(store.place.names(self.folder))
        for process in (name.removesuffix(ANSWER) for name in names if name.endswith(ANSWER)):
            if process + CONFIRMED not in names and store.place.get(f"{self.folder}/{process}{ANSWER}") == self.nonce:
                store.place.put(f"{self.folder}/{process}{CONFIRMED}", self.nonce)

    def prove(self, store_url: str) -> None:
        """In a worker: proves once that it sees the run's store; raises StoreError, naming host and path, where it does not."""
        if self.folder in _proven:
            return
        try:
            problem = self._problem(Store.at(store_url).place)
        except ServiceError:
            raise
        except StoreError as error:
            problem = str(error)
        if problem:
            raise StoreError(
                f"worker on {socket.gethostname()}: {store_url} is not the store of this run ({problem}); mount the same"
                " folder under the same path on every worker, or name one with --store that all of them have"
            )
        _proven.add(self.folder)

    def _problem(self, place: Place) -> str:
        if place.get(f"{self.folder}/run") != self.nonce:
            return "what the run wrote there is not there"
        process = _process_name(os.getpid())
        place.put(f"{self.folder}/{process}{ANSWER}", self.nonce)
        until = time.monotonic() + self.patience
        while time.monotonic() < until:
            if process + CONFIRMED in place.names(self.folder):
                return ""
            time.sleep(0.02)
        return "what the worker wrote there is not there for the run"


def sees(store: Store, key: str, artifact: str) -> bool:
    """Whether the record of a key and the artifact are there for this process.

    Where they are not at first, the folder of the records is listed, which makes a network file system look again.
    """
    for _ in range(2):
        if store.record(key) is not None and store.place.size(artifact_path(artifact)) is not None:
            return True
        store.place.names("records")
    return False


def missing(store: Store, made: Collection[tuple[str, str]]) -> set[tuple[str, str]]:
    """Those pairs of key and artifact of which the record or the artifact is not in the store now; folders are listed."""
    keys = set(store.records.listed())
    shards = {artifact_path(artifact).rpartition("/")[0] for _, artifact in made}
    there = {f"{shard}/{name}" for shard in shards for name in store.place.names(shard)}
    return {(key, artifact) for key, artifact in made if key not in keys or artifact_path(artifact) not in there}


def unseen(store: Store, label: str, record: Record | None) -> StoreError:
    """Something was computed, and this process does not find it."""
    host = record.host if record else "a worker"
    return StoreError(
        f"{label}: {host} computed it, but its record or artifact is not in {store.url} after {SEEN_WITHIN:g} s; check that"
        " the folder is the same on every worker, then run again"
    )


@functools.cache
def _process_name(_: int) -> str:
    """A name of this process that no other has, nor a fork of it."""
    return secrets.token_hex(6)
