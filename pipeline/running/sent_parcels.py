"""Parcels on dask's distributed scheduler: sent, computed in a worker, and their results received.

A worker sends the results of a parcel as an event of dask's, on the stream on which it then says that the parcel is done, and
the scheduler passes both on in that order. So results neither take a question to the worker nor die with it. Where no
event has come when a parcel is done, its results are fetched from the worker.
"""

import asyncio
import concurrent.futures
import contextlib
import math
import pickle
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from distributed import Client, KilledWorker, get_worker

from kinetree.errors import ClusterError, LostWorkerError
from kinetree.pipeline.running.execute import Result, execute
from kinetree.pipeline.running.following import MEMORY
from kinetree.pipeline.running.living_workers import LivingWorkers
from kinetree.pipeline.running.parcels import Demand

WAITS = {"_data_producer": True}
"""Has a parcel wait at the scheduler until a worker has room for it: dask otherwise gives it at once to one that is busy, for
however long, and other workers run out of work beside it."""
EVENT_BYTES = 2**16
"""Results of more bytes are fetched: the scheduler keeps the last thousand events of a run. A node takes about 7 kB."""


def sent(client: Client, workers: LivingWorkers, key: str, demand: Demand, work: tuple[Any, ...]) -> "Remote":
    """Sends a parcel; raises ClusterError where the client has lost its scheduler for good."""
    memory = workers.ask(key, demand.memory)
    options: dict[str, Any] = {"resources": {MEMORY: memory}} if memory else {}
    outcome = workers.expect(key)
    try:
        future = client.submit(computed, workers.topic, demand.tells, *work, key=key, pure=False, **WAITS, **options)
    except (OSError, RuntimeError) as error:
        raise ClusterError(f"the scheduler is gone ({type(error).__name__}); run again to go on") from error
    return Remote.of(client, workers, future, outcome, tells=demand.tells)


def computed(topic: str, tells: bool, *work: Any, _data_producer: bool = True) -> list[Result]:
    """In a worker: computes a parcel and sends its results to whoever listens for the topic.

    tells          : whether the scheduler is to have heard, before the parcel begins, that it does
    _data_producer : what a dask that does not know it of tasks hands on (WAITS)
    """
    worker = get_worker()
    key = worker.get_current_task()
    if tells:
        event = {"key": key, "worker": worker.address}
        asyncio.run_coroutine_threadsafe(worker.scheduler.log_event(topic=topic, msg=event), worker.loop.asyncio_loop).result()
    results = execute(*work)
    encoded = pickle.dumps(results)  # text of any kind, which msgpack refuses
    if len(encoded) <= EVENT_BYTES and _is_wanted(worker, key):
        worker.log_event(topic, {"key": key, "results": encoded})
    return results


def _is_wanted(worker: Any, key: str) -> bool:
    """Whether the run still waits for a parcel; else the scheduler would keep the event for as long as it lives."""
    parcel = worker.state.tasks.get(key)
    return parcel is not None and parcel.state != "cancelled"


@dataclass(frozen=True)
class Remote:
    """A parcel at the scheduler, whose results arrive or are fetched in the background.

    Where they are lost with their worker, the parcel is computed again, which the caller's thread must not wait for.
    """

    client: Client
    workers: LivingWorkers
    future: Any
    outcome: "concurrent.futures.Future[Any]"

    @staticmethod
    def of(
        client: Client, workers: LivingWorkers, future: Any, outcome: "concurrent.futures.Future[Any]", *, tells: bool
    ) -> "Remote":
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

        fetching = asyncio.run_coroutine_threadsafe(fetched(), client.loop.asyncio_loop)
        fetching.add_done_callback(partial(_pass_on, outcome))
        outcome.add_done_callback(partial(_forget, workers, future, fetching))
        return Remote(client, workers, future, outcome)

    def add_done_callback(self, call: Callable[["Remote"], None], /) -> None:
        """Calls when the results are there."""
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

    def give_up(self) -> str | None:
        """Nobody waits for it any longer; the process of its worker is ended and started anew, if a nanny looks after it."""
        _, worker = self.workers.began.get(self.future.key, (math.inf, ""))
        if self.outcome.done() or not worker:  # the client's thread forgets what has ended
            return None
        self.future.cancel()
        asyncio.run_coroutine_threadsafe(_restart(self.client, worker), self.client.loop.asyncio_loop)
        return f"worker {worker} is started anew, or goes on with it where no nanny looks after it"


async def _restart(client: Client, worker: str) -> None:
    """Ends the process of a worker, even one that does not answer; its other parcels are computed again elsewhere."""
    with contextlib.suppress(OSError, TimeoutError, ValueError, RuntimeError):
        await client.restart_workers([worker], raise_for_error=False)


def _forget(workers: LivingWorkers, future: Any, fetching: "concurrent.futures.Future[Any]", _: object) -> None:
    """The results have arrived; what the scheduler still holds for somebody is computed again where a worker ends."""
    workers.forget(future.key)
    fetching.cancel()
    future.release()


def _pass_on(outcome: "concurrent.futures.Future[Any]", fetching: "concurrent.futures.Future[Any]") -> None:
    """What was fetched is the outcome, unless its event has come; both happen in the thread of the client."""
    if outcome.done():
        return
    try:
        outcome.set_result(fetching.result())
    except (Exception, concurrent.futures.CancelledError) as error:
        outcome.set_exception(error)
