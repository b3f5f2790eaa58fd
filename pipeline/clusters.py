"""Where parcels are computed on dask's distributed scheduler: workers of this machine, or any scheduler's address."""

import asyncio
import concurrent.futures
import contextlib
import logging
import signal
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from distributed import Client, KilledWorker, LocalCluster, WorkerPlugin

from kinetree.errors import ClusterError, ConfigError, LostWorkerError

CONNECT_SECONDS = 10


@contextlib.contextmanager
def local(workers: int, memory: str | None) -> Iterator[Client]:
    """Processes of this machine, one thread each, gone when the block ends, however it ends."""
    with _quiet(), contextlib.ExitStack() as stack:
        cluster = stack.enter_context(
            LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                processes=True,
                memory_limit=memory or 0,
                dashboard_address="127.0.0.1:0",
                silence_logs=logging.CRITICAL,
            )
        )
        client = stack.enter_context(Client(cluster))
        client.register_plugin(_Deaf())
        try:
            yield client
        except BaseException:  # nodes in the middle may take minutes, and what they publish is whole or nothing
            cluster.sync(_kill, cluster)
            raise


@contextlib.contextmanager
def at(address: str) -> Iterator[Client]:
    """A scheduler that somebody else runs; raises ClusterError where nobody answers or it has no workers."""
    with _quiet():
        yield from _at(address)


def _at(address: str) -> Iterator[Client]:
    try:
        client = Client(address, timeout=CONNECT_SECONDS)
    except ValueError as error:
        raise ConfigError(f"--scheduler {address}: not an address ({error}); expected one such as tcp://host:8786") from None
    except (OSError, TimeoutError) as error:
        raise ClusterError(
            f"--scheduler {address}: nobody answers there within {CONNECT_SECONDS} s ({type(error).__name__});"
            " check the address and that the scheduler runs (dask scheduler), or leave --scheduler out"
        ) from error
    with client:
        if not client.scheduler_info()["workers"]:
            raise ClusterError(f"--scheduler {address}: the scheduler has no workers; start some (dask worker {address})")
        yield client


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


def slots(client: Client) -> int:
    """How many parcels the workers compute at the same time."""
    return max(1, sum(int(n) for n in client.nthreads().values()))


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
