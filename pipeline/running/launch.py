"""Where parcels go. In this process dask's synchronous executor computes them (a breakpoint inside a task works), or a pool of
threads; on workers, distributed does. Everything is a future.
"""

import contextlib
import os
import secrets
import threading
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, Protocol

import dask.config
from dask.local import SynchronousExecutor

from kinetree.errors import ConfigError
from kinetree.pipeline.running.execute import Step, execute
from kinetree.pipeline.running.own_workers import Starts
from kinetree.pipeline.running.parcels import Demand
from kinetree.pipeline.running.pool import Pool
from kinetree.pipeline.running.sight import Sight
from kinetree.pipeline.running.worker_parent import WorkerParent
from kinetree.pipeline.settings.config import Compute

UNWATCHED = {
    "distributed.admin.tick.interval": "1s",
    "distributed.worker.profile.enabled": False,
    "distributed.scheduler.active-memory-manager.start": False,
}
"""How dask watches processes of our own: its defaults look at every one fifty times a second, and at what a worker computes a
hundred times, for a performance report; results are too small to be moved about."""

METHOD = "distributed.worker.multiprocessing-method"
"""Where dask looks how it starts processes."""
ENVIRONMENT, TRIM = "distributed.nanny.pre-spawn-environ", "MALLOC_TRIM_THRESHOLD_"
"""What dask sets in the environment of our own processes; and of that, what makes them give back the memory of every array
at once, which the kernel then clears for the next one. It stays where workers have a limit of memory, at which dask stops them
by what they hold; where the run's own environment sets it, it holds."""
VARIABLES: Mapping[str, Any] = {"OMP_NUM_THREADS": 1, "MKL_NUM_THREADS": 1, "OPENBLAS_NUM_THREADS": 1, TRIM: 65536}
"""Those that dask sets unless it is configured otherwise: processes are begun before the run has imported most of dask."""


_CONFIGURING = threading.RLock()
_FORKING: list[contextlib.AbstractContextManager[Any]] = []
"""One for each run whose workers are forked; the first knows what dask was configured to before."""


class Future(Protocol):
    """What the loop asks of a parcel under way."""

    def add_done_callback(self, call: Callable[[Any], None], /) -> None:
        """Calls when done."""

    def result(self) -> Any:
        """The value, or raises."""

    def cancel(self) -> Any:
        """Takes it back where it has not begun."""

    def seconds(self) -> float:
        """How long it has been computed; 0 where it has not begun, has ended, or nobody knows."""

    def give_up(self) -> str | None:
        """Nobody waits for it any longer; what computes it is ended where that can be. Says in words what becomes of it.

        Nothing is given up, and None is the answer, where it has ended meanwhile: its results are there.
        """


def _nothing() -> None:
    """Nothing is to be looked after in this process."""


@dataclass(frozen=True)
class Launcher:
    """Where parcels go: `submit(name, demand, store_url, steps, sight)` gives a future of their results."""

    submit: Callable[[str, Demand, str, tuple[Step, ...], Sight], Future]
    window: Callable[[], int]
    """How many parcels may be out now: enough that no worker waits, few enough that the deepest go first."""
    is_apart: bool = True
    """Whether nodes run elsewhere than in the thread that runs the loop."""
    is_elsewhere: bool = False
    """Whether nodes run in other processes than the one that runs the loop."""
    look_after: Callable[[], None] = _nothing
    """Called now and then; raises ClusterError where nobody computes any more."""
    dashboard: str = ""
    """Address of dask's dashboard; empty where there is none."""


@contextlib.contextmanager
def launcher(compute: Compute, client: Any = None, parent: WorkerParent | None = None) -> Iterator[Launcher]:
    """The launcher that a configuration asks for, or one on a `distributed.Client` handed in.

    parent : what worker processes of this machine are forked from, perhaps begun already; None makes one
    """
    if client is not None or compute.is_cluster:
        from kinetree.pipeline.running import clusters
        from kinetree.pipeline.running.following import followed

        is_ours = client is None and not (compute.scheduler or compute.scheduler_file)
        with contextlib.ExitStack() as stack:
            if is_ours and not compute.cluster:
                parent = stack.enter_context(WorkerParent()) if parent is None else parent
                parent.begin(environment(compute))
                if parent.is_there:
                    stack.enter_context(_forking())
            starts = Starts()
            there = stack.enter_context(clusters.connected(compute, client, partial(_configured, compute), starts))
            yield _on_client(there, stack.enter_context(followed(there, compute, starts, is_ours=is_ours)), compute)
        return
    if compute.performance_report is not None:
        raise ConfigError("--performance-report: dask reports on workers; add --executor processes or --scheduler ADDRESS")
    with contextlib.ExitStack() as stack:
        if compute.executor == "threads":
            pool = Pool(compute.worker_count)
            # an interrupted run does not wait for nodes that may take minutes: what they publish is whole or nothing
            stack.callback(pool.close)
            yield Launcher(lambda _, __, *work: pool.submit(execute, *work), lambda: 2 * compute.worker_count)
        else:
            here = SynchronousExecutor()
            yield Launcher(lambda _, __, *work: here.submit(execute, *work), lambda: 1, is_apart=False)


@contextlib.contextmanager
def _configured(compute: Compute) -> Iterator[None]:
    """How dask starts and watches processes of this run; its configuration is one for all threads, so one at a time sets it."""
    watching = UNWATCHED if compute.performance_report is None else {}
    with _CONFIGURING, dask.config.set({ENVIRONMENT: environment(compute), **watching}):
        yield


@contextlib.contextmanager
def _forking() -> Iterator[None]:
    """Has dask fork processes until the last run of this program that asked for it is over."""
    with _CONFIGURING:
        if not _FORKING:
            _FORKING.append(dask.config.set({METHOD: "forkserver"}))
        else:
            _FORKING.append(contextlib.nullcontext())
    try:
        yield
    finally:
        with _CONFIGURING:
            ended = _FORKING.pop()
            if not _FORKING:
                ended.__exit__(None, None, None)


def environment(compute: Compute) -> dict[str, str]:
    """What is set in the environment of our own processes before they start."""
    with _CONFIGURING:
        wanted = {**VARIABLES, **dask.config.get(ENVIRONMENT, {})}
    own = {name: str(value) for name, value in wanted.items() if name != TRIM or compute.memory_bytes}
    return own | {name: os.environ[name] for name in own if name in os.environ}


def _on_client(client: Any, workers: Any, compute: Compute) -> Launcher:
    from kinetree.pipeline.running.clusters import dashboard
    from kinetree.pipeline.running.sent_parcels import sent

    run = secrets.token_hex(8)  # two runs on one scheduler never take each other's results
    expected = compute.workers or 1

    def submit(name: str, demand: Demand, url: str, steps: tuple[Step, ...], sight: Sight) -> Future:
        return sent(client, workers, f"{name}-{run}", demand, (url, steps, sight))

    def window() -> int:
        return 3 * max(expected, int(workers.threads))

    return Launcher(submit, window, is_elsewhere=True, look_after=workers.check, dashboard=dashboard(client))
