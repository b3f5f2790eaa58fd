"""Where parcels are computed on dask's distributed scheduler: workers of this machine, or any scheduler's address."""

import asyncio
import concurrent.futures
import contextlib
import copy
import importlib
import logging
import math
import signal
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from distributed import Client, KilledWorker, LocalCluster, Nanny, Security, WorkerPlugin, get_worker, performance_report
from distributed.utils import get_mp_context

from kinetree.errors import ClusterError, ConfigError, LostWorkerError
from kinetree.errors.small_text import small_json, small_text
from kinetree.pipeline.running.execute import Result, execute
from kinetree.pipeline.running.following import MEMORY, begun_topic
from kinetree.pipeline.running.living_workers import LivingWorkers
from kinetree.pipeline.running.own_workers import Starts, looked_after
from kinetree.pipeline.running.parcels import Demand
from kinetree.pipeline.running.worker_parent import refuse_within_import
from kinetree.pipeline.settings.config import Compute

CONNECT_SECONDS = 10
SCHEDULER_FILE_BYTES = 2**20
Configured = Callable[[], contextlib.AbstractContextManager[None]]
ALLOWED_DEATHS = 1
"""How often a parcel is tried on another of our own worker processes before its first node is tried alone."""
IDLE_PATIENCE = 2.0
"""Seconds in which a worker with nothing to do ends by itself."""
LEAST_MEMORY = 600_000_000
"""Bytes that our own worker process may be limited to at least. It holds 210 MB when forked, most of it shared, and 441 MB
with all tasks imported; at 80 % of its limit dask gives it no more work, at 95 % it is ended and started again, for ever."""
WAITS = {"_data_producer": True}
"""Has a parcel wait at the scheduler until a worker has room for it: dask otherwise gives it at once to one that is busy, for
however long, and other workers run out of work beside it."""
LOUD = ("distributed", "distributed.client", "distributed.nanny", "distributed.scheduler")
"""Loggers of dask's that write a page where a worker is killed."""
_SILENCING = threading.Lock()
_LEVELS: list[Mapping[str, int]] = []
"""Of these loggers, as every run that is quiet found them, in the order of their beginnings."""
_FILES = ("_file", "_cert", "_key")
"""How the arguments of distributed.Security end that name files."""


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
        cluster = stack.enter_context(_closed(made))
        try:
            with _closed(Client(cluster)) as client:  # first to go: what it waits for is computed again where a worker ends
                client.register_plugin(_Deaf())  # before there is any worker that could die while it is told
                cluster.scale(workers)
                with looked_after(cluster, workers, starts or Starts()):
                    yield client
        except BaseException:  # nodes in the middle may take minutes, and what they publish is whole or nothing
            cluster.sync(_end, cluster, patience=0.1)
            raise
        cluster.sync(_end, cluster, patience=IDLE_PATIENCE)


@contextlib.contextmanager
def _closed(opened: Any) -> Iterator[Any]:
    """Closes a client or a cluster; one that does not stop in time ends with this process and is no fault of the run."""
    try:
        yield opened
    finally:
        with contextlib.suppress(OSError, RuntimeError, TimeoutError):
            opened.close()


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


@contextlib.contextmanager
def connected(
    compute: Compute,
    client: Client | None = None,
    configured: Configured = contextlib.nullcontext,
    starts: Starts | None = None,
) -> Iterator[Client]:
    """The client handed in, or one of the cluster that the configuration names; raises ClusterError, ConfigError.

    configured, starts : as in `local`
    """
    with _quiet(), contextlib.ExitStack() as stack:
        if client is None and (compute.scheduler or compute.scheduler_file):
            client = stack.enter_context(at(compute))
        elif client is None and compute.cluster:
            client = stack.enter_context(started(compute))
        elif client is None:
            client = stack.enter_context(local(compute, configured, starts))
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
        address = compute.scheduler or _left_address(Path(str(compute.scheduler_file)))
        client = Client(address, timeout=CONNECT_SECONDS, **secured(compute, asked))
    except (ValueError, KeyError, TypeError) as error:
        raise ConfigError(f"{asked}: not an address ({error}); expected one such as tcp://host:8786") from None
    except (OSError, TimeoutError) as error:
        raise ClusterError(
            f"{asked}: nobody answers there within {CONNECT_SECONDS} s ({type(error).__name__});"
            " check the address and that the scheduler runs (dask scheduler), or leave the option out"
        ) from error
    with _closed(client):
        yield client


def secured(compute: Compute, scheduler: str = "") -> dict[str, Security]:
    """The argument of dask's classes that secures their connections, if the configuration names one; raises ConfigError.

    scheduler : how the configuration names one that somebody else runs; empty where the run starts its own
    """
    wanted = compute.security
    if not wanted:
        return {}
    if wanted == "temporary":
        if scheduler:
            raise ConfigError(
                f"compute.security temporary: {scheduler} has certificates of its own; name them: tls_ca_file, tls_client_cert,"
                " tls_client_key"
            )
        try:
            return {"security": Security.temporary()}
        except ImportError:
            raise ConfigError("compute.security temporary: cryptography is not installed; pip install cryptography") from None
    if missing := [f"{key} {path}" for key, path in wanted.items() if key.endswith(_FILES) and not Path(path).is_file()]:
        raise ConfigError(f"compute.security: {missing[0]}: there is no such file")
    try:
        return {"security": Security(require_encryption=True, **wanted)}
    except (TypeError, ValueError) as error:
        raise ConfigError(f"compute.security: {error}") from None


def _left_address(file: Path) -> str:
    """What a scheduler left in its file; raises OSError where the file is not there yet."""
    file.stat()
    scheduler = small_json(small_text(file, ConfigError, SCHEDULER_FILE_BYTES), str(file), ConfigError)
    return str(scheduler["address"])


@contextlib.contextmanager
def started(compute: Compute) -> Iterator[Client]:
    """Workers that a class of the configuration starts, gone when the block ends."""
    with contextlib.ExitStack() as stack:
        cluster = stack.enter_context(_closed(cluster_of(compute)))
        if compute.adapt is not None:
            cluster.adapt(minimum=compute.adapt[0], maximum=compute.adapt[1])
        else:
            cluster.scale(compute.workers or 1)
        yield stack.enter_context(_closed(Client(cluster)))


def cluster_of(compute: Compute) -> Any:
    """The cluster that a configuration names by class and options; raises ConfigError, ClusterError."""
    module, _, name = str(compute.cluster).partition(":")
    try:
        made = getattr(importlib.import_module(module), name)
    except (ImportError, AttributeError) as error:
        raise ConfigError(f"compute.cluster {compute.cluster}: {error}; pip install 'kinetree[cluster]'") from None
    try:
        return made(**{**secured(compute), **compute.options})
    except (TypeError, ValueError) as error:
        raise ConfigError(f"compute.options: {compute.cluster} refuses them: {error}") from None
    except (OSError, RuntimeError) as error:
        raise ClusterError(f"compute.cluster {compute.cluster}: {error}") from error


def dashboard(client: Client) -> str:
    """Address of the dashboard; empty where its scheduler has none."""
    return str(client.dashboard_link or "") if find_spec("bokeh") is not None else ""


def sent(client: Client, workers: LivingWorkers, key: str, demand: Demand, work: tuple[Any, ...]) -> "Remote":
    """Sends a parcel; raises ClusterError where the client has lost its scheduler for good."""
    topic = begun_topic(client) if demand.tells else ""
    memory = workers.ask(key, demand.memory)
    options: dict[str, Any] = {"resources": {MEMORY: memory}} if memory else {}
    try:
        future = client.submit(computed, topic, *work, key=key, pure=False, **WAITS, **options)
    except (OSError, RuntimeError) as error:
        raise ClusterError(f"the scheduler is gone ({type(error).__name__}); run again to go on") from error
    return Remote.of(client, workers, future, tells=demand.tells)


def computed(topic: str, *work: Any, _data_producer: bool = True) -> list[Result]:
    """In a worker: computes a parcel; where there is a topic, the scheduler has heard under it before that it begins.

    _data_producer : what a dask that does not know it of tasks hands on (WAITS)
    """
    if topic:
        worker = get_worker()
        event = {"key": worker.get_current_task(), "worker": worker.address}
        asyncio.run_coroutine_threadsafe(worker.scheduler.log_event(topic=topic, msg=event), worker.loop.asyncio_loop).result()
    return execute(*work)


@dataclass(frozen=True)
class Remote:
    """A future of distributed whose result is fetched as soon as it is there, in the background.

    A result that dies with its worker before it is fetched is computed again, which the caller's thread must not wait for.
    """

    client: Client
    workers: LivingWorkers
    future: Any
    outcome: "concurrent.futures.Future[Any]"

    @staticmethod
    def of(client: Client, workers: LivingWorkers, future: Any, *, tells: bool) -> "Remote":
        """For a future of a client; `tells` where its worker tells that it begins."""

        async def fetched() -> Any:
            try:
                return await future
            except KilledWorker as error:
                lost = LostWorkerError(f"the worker was lost ({error}); perhaps it ran out of memory")
                lost.has_begun = not tells or workers.is_begun(future.key, error.last_worker.address)
                raise lost from None
            except OSError as error:  # of the network: what a task raises comes as a result
                raise ClusterError(f"the scheduler is gone ({type(error).__name__}); run again to go on") from None
            finally:
                future.release()  # or it is computed again where a worker ends that still holds it

        outcome = asyncio.run_coroutine_threadsafe(fetched(), client.loop.asyncio_loop)
        outcome.add_done_callback(lambda _: workers.forget(future.key))
        return Remote(client, workers, future, outcome)

    def add_done_callback(self, call: Callable[["Remote"], None], /) -> None:
        """Calls when the result was fetched."""
        self.outcome.add_done_callback(lambda _: call(self))

    def result(self) -> Any:
        """The value, or raises."""
        return self.outcome.result()

    def cancel(self) -> None:
        """Takes it back where it has not begun."""
        self.future.cancel()

    def seconds(self) -> float:
        """How long a worker has been computing it; 0 where it has not begun, or has no limit of time."""
        began, _ = self.workers.began.get(self.future.key, (math.inf, ""))
        return max(0.0, time.monotonic() - began)

    def give_up(self) -> str:
        """Nobody waits for it any longer; the process of its worker is ended and started anew, if a nanny looks after it."""
        _, worker = self.workers.began[self.future.key]
        self.future.cancel()
        asyncio.run_coroutine_threadsafe(_restart(self.client, worker), self.client.loop.asyncio_loop)
        return f"worker {worker} is started anew, or goes on with it where no nanny looks after it"


async def _restart(client: Client, worker: str) -> None:
    """Ends the process of a worker, even one that does not answer; its other parcels are computed again elsewhere."""
    with contextlib.suppress(OSError, TimeoutError, ValueError, RuntimeError):
        await client.restart_workers([worker], raise_for_error=False)


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


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """A worker that was killed is our message to give, not a page of the library's log; the last run of this program that
    is quiet gives the loggers back the levels that the first one found.
    """
    with _SILENCING:
        _LEVELS.append({name: logging.getLogger(name).level for name in LOUD})
        for name in LOUD:
            logging.getLogger(name).setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        with _SILENCING:
            before = _LEVELS.pop()
            if not _LEVELS:
                for name, level in before.items():
                    logging.getLogger(name).setLevel(level)
