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


@contextlib.contextmanager
def followed(client: Any, compute: Compute, starts: Starts | None = None, *, is_ours: bool = False) -> Iterator[LivingWorkers]:
    """The workers of a client while they come and go, those asked for already there; raises ClusterError where they are not.

    starts  : of our own workers, which may all end while they start
    is_ours : whether they are started with the memory that the configuration names
    """
    wanted, seconds = compute.wanted_workers
    workers = LivingWorkers(seconds, memory=(compute.memory_bytes or 0) if is_ours else 0, starts=starts or Starts())
    client.subscribe_topic(begun_topic(client), workers.hear_begun)
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


def begun_topic(client: Any) -> str:
    """Under which its workers tell a client that they begin a parcel."""
    return f"begun-{client.id}"
