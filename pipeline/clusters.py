"""Where parcels are computed on dask's distributed scheduler: workers of this machine, or any scheduler's address."""

import asyncio
import concurrent.futures
import contextlib
import importlib
import logging
import signal
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from distributed import Client, KilledWorker, LocalCluster, WorkerPlugin, performance_report

from kinetree.errors import ClusterError, ConfigError, LostWorkerError
from kinetree.errors.small_text import small_json, small_text
from kinetree.pipeline.config import Compute

CONNECT_SECONDS = 10
SCHEDULER_FILE_BYTES = 2**20
ALLOWED_DEATHS = 1
"""How often a parcel is tried on another of our own worker processes before its first node is tried alone."""
FOLLOW_SECONDS = 0.25
"""How often the scheduler is asked for its workers."""
REPLACE_SECONDS = 30.0
"""Without any worker of our own, after which new ones are started: several times what a start takes on a busy machine."""


@contextlib.contextmanager
def local(workers: int, memory: str | None) -> Iterator[Client]:
    """Processes of this machine, one thread each, gone when the block ends, however it ends."""
    with contextlib.ExitStack() as stack:
        cluster = stack.enter_context(
            LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                processes=True,
                memory_limit=memory or 0,
                dashboard_address="127.0.0.1:0",
                silence_logs=logging.CRITICAL,
                scheduler_kwargs={"allowed_failures": ALLOWED_DEATHS},
            )
        )
        client = stack.enter_context(Client(cluster))
        client.register_plugin(_Deaf())
        stack.enter_context(_kept_up(cluster, workers))
        try:
            yield client
        except BaseException:  # nodes in the middle may take minutes, and what they publish is whole or nothing
            cluster.sync(_kill, cluster)
            raise


@contextlib.contextmanager
def _kept_up(cluster: LocalCluster, workers: int) -> Iterator[None]:
    """Replaces our own workers where none is left: one that dies while it starts is not started again by its nanny."""
    keeping = asyncio.run_coroutine_threadsafe(_keep_up(cluster, workers), cluster.loop.asyncio_loop)
    try:
        yield
    finally:
        keeping.cancel()


async def _keep_up(cluster: LocalCluster, workers: int) -> None:
    empty = 0.0
    while True:
        await asyncio.sleep(FOLLOW_SECONDS)
        empty = 0.0 if cluster.scheduler.workers else empty + FOLLOW_SECONDS
        if empty > REPLACE_SECONDS:
            empty = 0.0
            cluster.scale(0)
            while cluster.workers:  # names are given anew once their workers are gone
                await asyncio.sleep(FOLLOW_SECONDS)
            cluster.scale(workers)


@contextlib.contextmanager
def connected(compute: Compute, client: Client | None = None) -> Iterator[Client]:
    """The client handed in, or one of the cluster that the configuration names; raises ClusterError, ConfigError."""
    with _quiet(), contextlib.ExitStack() as stack:
        if client is None and (compute.scheduler or compute.scheduler_file):
            client = stack.enter_context(at(compute))
        elif client is None and compute.cluster:
            client = stack.enter_context(started(compute))
        elif client is None:
            client = stack.enter_context(local(compute.worker_count, compute.memory))
        if compute.performance_report is not None:
            if find_spec("bokeh") is None:
                raise ConfigError("--performance-report: bokeh is not installed; pip install 'kinetree[cluster]'")
            stack.enter_context(client.as_current())
            stack.enter_context(performance_report(filename=compute.performance_report))
        yield client


@contextlib.contextmanager
def at(compute: Compute) -> Iterator[Client]:
    """A scheduler that somebody else runs; raises ClusterError where nobody answers."""
    asked = f"--scheduler {compute.scheduler}" if compute.scheduler else f"--scheduler-file {compute.scheduler_file}"
    try:
        client = Client(compute.scheduler or _left_address(Path(str(compute.scheduler_file))), timeout=CONNECT_SECONDS)
    except (ValueError, KeyError, TypeError) as error:
        raise ConfigError(f"{asked}: not an address ({error}); expected one such as tcp://host:8786") from None
    except (OSError, TimeoutError) as error:
        raise ClusterError(
            f"{asked}: nobody answers there within {CONNECT_SECONDS} s ({type(error).__name__});"
            " check the address and that the scheduler runs (dask scheduler), or leave the option out"
        ) from error
    with client:
        yield client


def _left_address(file: Path) -> str:
    """What a scheduler left in its file; raises OSError where the file is not there yet."""
    file.stat()
    held = small_json(small_text(file, ConfigError, SCHEDULER_FILE_BYTES), str(file), ConfigError)
    return str(held["address"])


@contextlib.contextmanager
def started(compute: Compute) -> Iterator[Client]:
    """Workers that a class of the configuration starts, gone when the block ends."""
    with contextlib.ExitStack() as stack:
        cluster = stack.enter_context(cluster_of(compute))
        if compute.adapt is not None:
            cluster.adapt(minimum=compute.adapt[0], maximum=compute.adapt[1])
        else:
            cluster.scale(compute.workers or 1)
        yield stack.enter_context(Client(cluster))


def cluster_of(compute: Compute) -> Any:
    """The cluster that a configuration names by class and options; raises ConfigError, ClusterError."""
    module, _, name = str(compute.cluster).partition(":")
    try:
        made = getattr(importlib.import_module(module), name)
    except (ImportError, AttributeError) as error:
        raise ConfigError(f"compute.cluster {compute.cluster}: {error}; pip install 'kinetree[cluster]'") from None
    try:
        return made(**compute.options)
    except (TypeError, ValueError) as error:
        raise ConfigError(f"compute.options: {compute.cluster} refuses them: {error}") from None
    except (OSError, RuntimeError) as error:
        raise ClusterError(f"compute.cluster {compute.cluster}: {error}") from error


@dataclass
class Workers:
    """How many workers and threads there are, asked for in the background."""

    patience: float
    """Seconds without any worker after which a run gives up."""
    count: int = 0
    threads: int = 0
    _seen: float = field(default_factory=time.monotonic)

    def hear(self, threads: Mapping[str, int]) -> None:
        """Threads by worker, as the scheduler knows them now."""
        self.count, self.threads = len(threads), sum(threads.values())
        if self.count:
            self._seen = time.monotonic()

    def check(self) -> None:
        """Raises ClusterError where there was no worker for too long."""
        if time.monotonic() - self._seen > max(self.patience, 2 * FOLLOW_SECONDS):
            raise ClusterError(
                f"no worker for {self.patience:g} s; start some (dask worker ADDRESS), or give a queue more time"
                " (--wait-workers N,SECONDS)"
            )


@contextlib.contextmanager
def followed(client: Client, compute: Compute) -> Iterator[Workers]:
    """The workers of a client while they come and go, those asked for already there; raises ClusterError where they are not."""
    wanted, seconds = compute.wanted_workers
    workers = Workers(seconds)
    following = asyncio.run_coroutine_threadsafe(_follow(client, workers), client.loop.asyncio_loop)
    try:
        until = time.monotonic() + seconds
        while workers.count < wanted:
            if time.monotonic() > until:
                raise ClusterError(
                    f"--wait-workers {wanted}: {workers.count} workers are there after {seconds:g} s; start more, or wait"
                    " longer (--wait-workers N,SECONDS)"
                )
            time.sleep(0.05)
        yield workers
    finally:
        following.cancel()


async def _follow(client: Client, workers: Workers) -> None:
    while True:
        with contextlib.suppress(OSError, TimeoutError):  # a scheduler that does not answer is the client's to notice
            workers.hear(await client.scheduler.ncores())
        await asyncio.sleep(FOLLOW_SECONDS)


def dashboard(client: Client) -> str:
    """Address of the dashboard; empty where its scheduler has none."""
    return str(client.dashboard_link or "") if find_spec("bokeh") is not None else ""


@dataclass(frozen=True)
class Remote:
    """A future of distributed whose result is fetched as soon as it is there, in the background.

    A result that dies with its worker before it is fetched is computed again, which the caller's thread must not wait for.
    """

    future: Any
    outcome: "concurrent.futures.Future[Any]"

    @staticmethod
    def of(client: Client, future: Any) -> "Remote":
        """For a future of a client."""

        async def fetched() -> Any:
            try:
                return await future
            except KilledWorker as error:
                raise LostWorkerError(f"the worker was lost ({error}); perhaps it ran out of memory") from None

        return Remote(future, asyncio.run_coroutine_threadsafe(fetched(), client.loop.asyncio_loop))

    def add_done_callback(self, call: Callable[["Remote"], None], /) -> None:
        """Calls when the result was fetched."""
        self.outcome.add_done_callback(lambda _: call(self))

    def result(self) -> Any:
        """The value, or raises."""
        return self.outcome.result()

    def cancel(self) -> None:
        """Takes it back where it has not begun."""
        self.future.cancel()


class _Deaf(WorkerPlugin):  # type: ignore[misc]
    """Ctrl-C reaches every process of the terminal; what becomes of the workers is for the run to say."""

    def setup(self, worker: Any) -> None:
        """Called in a worker when it starts, and in one that takes its place."""
        signal.signal(signal.SIGINT, signal.SIG_IGN)


async def _kill(cluster: Any) -> None:
    """Ends the workers at once; one that takes longer than it should to be gone is no fault of the run."""
    await asyncio.gather(*(nanny.kill(timeout=0.1) for nanny in cluster.workers.values()), return_exceptions=True)


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """A worker that was killed is our message to give, not a page of the library's log."""
    loggers = [logging.getLogger(f"distributed{part}") for part in ("", ".client", ".nanny", ".scheduler")]
    before: list[Any] = [logger.level for logger in loggers]
    for logger in loggers:
        logger.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        for logger, level in zip(loggers, before, strict=True):
            logger.setLevel(level)
