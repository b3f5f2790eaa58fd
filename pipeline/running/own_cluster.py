"""Worker processes of this machine that a run starts, and their end."""

import asyncio
import contextlib
import copy
import logging
import signal
from collections.abc import Callable, Iterator
from typing import Any

from distributed import Client, LocalCluster, Nanny, WorkerPlugin
from distributed.utils import get_mp_context

from kinetree.errors import ConfigError
from kinetree.pipeline.running.connections import closed, secured
from kinetree.pipeline.running.following import MEMORY
from kinetree.pipeline.running.own_workers import Starts, looked_after
from kinetree.pipeline.running.worker_parent import refuse_within_import
from kinetree.pipeline.settings.config import Compute

Configured = Callable[[], contextlib.AbstractContextManager[None]]
ALLOWED_DEATHS = 1
"""How often a parcel is tried on another of our own worker processes before its first node is tried alone."""
IDLE_PATIENCE = 2.0
"""Seconds in which a worker with nothing to do ends by itself."""
LEAST_MEMORY = 600_000_000
"""Bytes that our own worker process may be limited to at least. It holds 210 MB when forked, most of it shared, and 441 MB
with all tasks imported; at 80 % of its limit dask gives it no more work, at 95 % it is ended and started again, for ever."""


@contextlib.contextmanager
def local(compute: Compute, configured: Configured = contextlib.nullcontext, starts: Starts | None = None) -> Iterator[Client]:
    """Processes of this machine, one thread each, gone when the block ends, however it ends.

    configured : a context with what dask is to be configured to where they are made, and nowhere else
    starts     : counts how often they ended while they started, and has the error after which nobody looks after them
    raises     : ConfigError where they may hold less memory than they need for their code
    """
    refuse_within_import()
    workers, memory = compute.worker_count, compute.memory_bytes
    if memory is not None and memory < LEAST_MEMORY:
        raise ConfigError(
            f"compute.memory {compute.memory}: a worker process needs {LEAST_MEMORY // 10**6} MB at least, most of it for code;"
            " give it more, or leave it out for no limit"
        )
    with contextlib.ExitStack() as stack:
        with configured():  # what the scheduler takes
            made = LocalCluster(
                n_workers=0,
                threads_per_worker=1,
                worker_class=OwnNanny,
                configured=configured,
                memory_limit=memory or 0,
                resources={MEMORY: memory} if memory else {},
                dashboard_address="127.0.0.1:0",
                silence_logs=logging.CRITICAL,
                scheduler_kwargs={"allowed_failures": ALLOWED_DEATHS},
                **secured(compute),
            )
        cluster = stack.enter_context(closed(made))
        try:
            with closed(Client(cluster)) as client:  # first to go: what it waits for is computed again where a worker ends
                client.register_plugin(_Deaf())  # before there is any worker that could die while it is told
                cluster.scale(workers)
                with looked_after(cluster, workers, starts or Starts()):
                    yield client
        except BaseException:  # nodes in the middle may take minutes, and what they publish is whole or nothing
            cluster.sync(_end, cluster, patience=0.1)
            raise
        cluster.sync(_end, cluster, patience=IDLE_PATIENCE)


class OwnNanny(Nanny):  # type: ignore[misc]
    """Looks after one of our own worker processes, configured as it is and not as another run of this program is."""

    config: dict[str, Any]
    pre_spawn_env: dict[str, str]

    def __init__(self, *args: Any, configured: Configured, **options: Any) -> None:
        with configured():
            super().__init__(*args, **options)
            self.config = copy.deepcopy(self.config)  # its inner parts are those of the program's
        if get_mp_context().get_start_method() == "forkserver":
            self.pre_spawn_env = {}  # dask would leave it in this program's own environment; a forked worker sets it itself


class _Deaf(WorkerPlugin):  # type: ignore[misc]
    """Ctrl-C reaches every process of the terminal; what becomes of the workers is for the run to say."""

    def setup(self, worker: Any) -> None:
        """Called in a worker when it starts, and in one that takes its place."""
        signal.signal(signal.SIGINT, signal.SIG_IGN)


async def _end(cluster: Any, patience: float) -> None:
    """Ends the workers, all at once, and none is started again; one that takes longer than it should is no fault of the run."""
    for nanny in cluster.workers.values():
        nanny.close_gracefully()
    await asyncio.gather(*(nanny.kill(timeout=patience) for nanny in cluster.workers.values()), return_exceptions=True)
