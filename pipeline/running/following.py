"""The workers of a cluster while they come and go: the scheduler is asked for them in the background."""

import asyncio
import contextlib
import time
from collections.abc import Iterator
from typing import Any

from kinetree.errors import ClusterError
from kinetree.pipeline.running.living_workers import LivingWorkers
from kinetree.pipeline.running.own_workers import FOLLOW_SECONDS, Starts
from kinetree.pipeline.settings.config import Compute

MEMORY = "memory"
"""The resource of dask that says how many bytes a worker has for nodes."""
DROP_SECONDS = 2.0
"""How long a scheduler is given to forget the events of a run."""


@contextlib.contextmanager
def followed(client: Any, compute: Compute, starts: Starts | None = None, *, is_ours: bool = False) -> Iterator[LivingWorkers]:
    """The workers of a client while they come and go, those asked for already there; raises ClusterError where they are not.

    starts  : of our own workers, which may all end while they start
    is_ours : whether they are started with the memory that the configuration names
    """
    wanted, seconds = compute.wanted_workers
    workers = LivingWorkers(seconds, memory=(compute.memory_bytes or 0) if is_ours else 0, starts=starts or Starts())
    client.subscribe_topic(workers.topic, workers.hear_of_parcel)
    following = asyncio.run_coroutine_threadsafe(_follow(client, workers), client.loop.asyncio_loop)
    try:
        until = time.monotonic() + seconds
        while workers.count < wanted or not workers.is_known:
            if time.monotonic() > until and workers.is_known:
                raise ClusterError(
                    f"--wait-workers {wanted}: {workers.count} workers are there after {seconds:g} s; start more, or wait"
                    " longer (--wait-workers N,SECONDS)"
                )
            workers.starts.check()
            if not workers.is_known:
                workers.check()
            time.sleep(0.02)
        yield workers
    finally:
        following.cancel()
        with contextlib.suppress(Exception):  # a scheduler that is gone or runs no functions keeps the last thousand events
            client.subscribe_topic(workers.topic, _ignored)  # a client never drops a handler, and with it what it refers to
            client.unsubscribe_topic(workers.topic)
            if not is_ours:
                asyncio.run_coroutine_threadsafe(_drop_events(client, workers.topic), client.loop.asyncio_loop).result(
                    DROP_SECONDS
                )


def _ignored(_: object) -> None:
    """An event that comes after the end of a run."""


async def _drop_events(client: Any, topic: str) -> None:
    """Has the scheduler forget the events of a run, which it would keep as long as it lives."""

    def drop(topic: str, dask_scheduler: Any) -> None:  # travels by value, so that a scheduler needs nothing of ours
        dask_scheduler._broker._topics.pop(topic, None)

    await client.run_on_scheduler(drop, topic)


async def _follow(client: Any, workers: LivingWorkers) -> None:
    memory: dict[str, int] = {}
    known: set[str] = set()
    while True:
        with contextlib.suppress(OSError, TimeoutError):  # a scheduler that does not answer is the client's to notice
            threads = await client.scheduler.ncores()
            if set(threads) != known:  # all that is known of many workers is much to send four times a second
                workers_now = (await client.scheduler.identity(n_workers=-1))["workers"]
                memory = {a: int(w["resources"][MEMORY]) for a, w in workers_now.items() if MEMORY in w["resources"]}
                known = set(threads)
            workers.hear(threads, memory)
        await asyncio.sleep(FOLLOW_SECONDS)
