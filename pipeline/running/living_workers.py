"""What is known of a cluster's workers: how many there are, what they declare, and what they have begun."""

import pickle
import secrets
import time
from collections.abc import Mapping
from concurrent.futures import Future
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

from kinetree.errors import ClusterError
from kinetree.pipeline.running.own_workers import FOLLOW_SECONDS, Starts


@dataclass
class LivingWorkers:
    """How many workers and threads there are, asked for in the background, and what they tell of themselves."""

    patience: float
    """Seconds without any worker after which a run gives up."""
    count: int = 0
    threads: int = 0
    memory: int = 0
    """The most bytes that one of them declares to have for nodes, or will declare; 0 where none does."""
    began: dict[str, tuple[float, str]] = field(default_factory=dict)
    """By dask's key, when a parcel that tells it was begun last, and the address of the worker."""
    topic: str = field(default_factory=lambda: f"parcels-{secrets.token_hex(8)}")
    """Of dask's events: workers tell this run under it that they begin a parcel, and what its results are."""
    starts: Starts = field(default_factory=Starts)
    """Of our own."""
    is_known: bool = False
    """Whether the scheduler has answered once."""
    _answered: float = field(default_factory=time.monotonic)
    _seen: float = field(default_factory=time.monotonic)
    _asked: dict[str, int] = field(default_factory=dict)
    _outcomes: "dict[str, Future[Any]]" = field(default_factory=dict)
    _fitting: float = field(default_factory=time.monotonic)

    def hear(self, threads: Mapping[str, int], memory: Mapping[str, int] = MappingProxyType({})) -> None:
        """Threads and declared bytes by worker, as the scheduler knows them now."""
        self.count, self.threads = len(threads), sum(threads.values())
        self.is_known, self._answered = True, time.monotonic()
        if self.count:
            self._seen = self._answered
            self.memory = max(memory.values(), default=0)
        if self.memory >= self._most_asked:
            self._fitting = self._answered

    def hear_of_parcel(self, event: tuple[float, Mapping[str, Any]]) -> None:
        """A worker has begun a parcel, or is done with it."""
        _, message = event
        outcome = self._outcomes.get(message["key"])
        if outcome is None:  # the parcel is over
            return
        if "results" not in message:
            self.began[message["key"]] = (time.monotonic(), message["worker"])
        else:
            outcome.set_result(pickle.loads(message["results"]))

    def expect(self, key: str) -> "Future[Any]":
        """A parcel is sent; its results, when they have come."""
        self._outcomes[key] = Future()
        return self._outcomes[key]

    def is_begun(self, key: str, worker: str) -> bool:
        """Whether the worker at this address is the last that told that it begins a parcel."""
        return key in self.began and self.began[key][1] == worker

    def ask(self, key: str, memory: int) -> int:
        """The bytes to ask for a parcel: no more than one of the workers has."""
        self._asked[key] = min(memory, self.memory)
        return self._asked[key]

    def forget(self, key: str) -> None:
        """A parcel is over."""
        self._asked.pop(key, None)
        self._outcomes.pop(key, None)
        self.began.pop(key, None)

    @property
    def _most_asked(self) -> int:
        return max([*self._asked.values()], default=0)

    def check(self) -> None:
        """Raises ClusterError where nobody answered, or there was no worker, for too long, or none of our own starts."""
        self.starts.check()
        long_ago = time.monotonic() - max(self.patience, 2 * FOLLOW_SECONDS)
        if self._answered < long_ago:
            raise ClusterError(f"the scheduler has not answered for {self.patience:g} s; check that it runs, then run again")
        if self._seen < long_ago:
            raise ClusterError(
                f"no worker for {self.patience:g} s; start some (dask worker ADDRESS), or give a queue more time"
                " (--wait-workers N,SECONDS)"
            )
        if self._fitting < long_ago:
            raise ClusterError(
                f"no worker for {self.patience:g} s that declares {self._most_asked / 1e9:.1f} GB of memory (dask worker"
                " --resources memory=BYTES); start one, or run again to go on with those that are there"
            )
