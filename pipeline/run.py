"""Runs a schedule on dask until nothing is left to run: parcels out, results in, the schedule told.

Everything is a future. In this process dask's synchronous executor makes them (a breakpoint inside a task works), or a pool
of threads; on workers, distributed does.
"""

import contextlib
import itertools
import queue
import secrets
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from typing import Any, Protocol

from dask.local import SynchronousExecutor

from kinetree.errors import ClusterError, GraphError, InputError, StoreError, StoreFullError
from kinetree.pipeline.config import Compute
from kinetree.pipeline.events import Watch
from kinetree.pipeline.execute import Input, Ref, Result, Step, execute, forget_reads
from kinetree.pipeline.node import Node
from kinetree.pipeline.schedule import DONE, Entry, Schedule


class Future(Protocol):
    """What futures of the standard library and of distributed have in common."""

    def add_done_callback(self, call: Callable[[Any], None], /) -> None:
        """Calls when done."""

    def result(self) -> Any:
        """The value, or raises."""

    def cancel(self) -> Any:
        """Takes it back where it has not begun."""


@dataclass(frozen=True)
class Launcher:
    """Where parcels go: `submit(name, store_url, steps)` gives a future of their results."""

    submit: Callable[[str, str, tuple[Step, ...]], Future]
    window: int
    """How many parcels may be out at once: enough that no worker waits, few enough that the deepest go first."""
    is_apart: bool = True
    """Whether nodes run elsewhere than in the thread that runs the loop."""


@contextlib.contextmanager
def launcher(compute: Compute, client: Any = None) -> Iterator[Launcher]:
    """The launcher that a configuration asks for, or one on a `distributed.Client` handed in."""
    with contextlib.ExitStack() as stack:
        if client is None and compute.scheduler:
            from kinetree.pipeline import clusters

            client = stack.enter_context(clusters.at(compute.scheduler))
        elif client is None and compute.executor == "processes":
            from kinetree.pipeline import clusters

            client = stack.enter_context(clusters.local(compute.worker_count, compute.memory))
        if client is not None:
            yield _on_client(client)
        elif compute.executor == "threads":
            pool = ThreadPoolExecutor(compute.worker_count)
            # an interrupted run does not wait for nodes that may take minutes: what they publish is whole or nothing
            stack.callback(pool.shutdown, wait=False, cancel_futures=True)
            yield Launcher(lambda _, url, steps: pool.submit(execute, url, steps), 2 * compute.worker_count)
        else:
            here = SynchronousExecutor()
            yield Launcher(lambda _, url, steps: here.submit(execute, url, steps), 1, is_apart=False)


def run(schedule: Schedule, launch: Launcher, watch: Watch) -> None:
    """Runs until every node is done, failed or skipped.

    raises : StoreError, ClusterError where going on makes no sense; KeyboardInterrupt; either way the store is whole
    """
    forget_reads()
    loop = _Loop(schedule, launch, watch)
    try:
        with _interruptible(loop):
            while loop.send() or loop.out:
                loop.receive()
        _refuse_rings(schedule)
    except BaseException:
        for future in loop.out.values():
            future.cancel()
        loop.out.clear()
        raise


@contextlib.contextmanager
def _interruptible(loop: "_Loop") -> Iterator[None]:
    """Ctrl-C and SIGTERM become something the loop receives, so that it stops where it is at rest.

    Raised wherever the thread happens to be, they can leave a lock of a library held for ever. A node that runs in this
    very thread is interrupted as usual. A signal that whoever started this process had it ignore (nohup, a job in the
    background) stays ignored.
    """
    if not loop.launch.is_apart or threading.current_thread() is not threading.main_thread():
        yield
        return
    heeded = [n for n in (signal.SIGINT, signal.SIGTERM) if signal.getsignal(n) is not signal.SIG_IGN]
    before = {number: signal.signal(number, loop.interrupt) for number in heeded}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler if handler is not None else signal.SIG_DFL)


@dataclass
class _Loop:
    schedule: Schedule
    launch: Launcher
    watch: Watch
    out: dict[int, Future] = field(default_factory=dict)
    _parcels: dict[int, list[Entry]] = field(default_factory=dict)
    _done: "queue.SimpleQueue[tuple[int, Future | None]]" = field(default_factory=queue.SimpleQueue)
    _twins: dict[str, list[Node]] = field(default_factory=dict)
    """Nodes that wait for a parcel under way which computes the same key."""
    _numbers: Iterator[int] = field(default_factory=itertools.count)
    _ready: Iterator[Entry] | None = None

    def send(self) -> bool:
        """Sends ready nodes while the window has room; True if any went."""
        sent = False
        for entry in self.schedule.ready() if len(self.out) < self.launch.window else ():
            if entry.key in self._twins:
                self._twins[entry.key].append(entry.node)
                continue
            self._send(entry)
            sent = True
            if len(self.out) >= self.launch.window:
                break
        return sent

    def interrupt(self, *_: object) -> None:
        """Makes the loop stop at what it receives next; safe to call from a signal's handler."""
        self._done.put((-1, None))

    def receive(self) -> None:
        """Waits for one parcel and tells the schedule what became of it."""
        number, future = self._done.get()
        if future is None:
            raise KeyboardInterrupt
        del self.out[number]
        parcel = self._parcels.pop(number)
        try:
            results: list[Result] = future.result()
        except CancelledError:
            raise ClusterError("the scheduler cancelled the work; was it stopped? Run again to go on") from None
        except (KeyboardInterrupt, SystemExit):
            raise
        except Exception as error:  # the worker died too often, or cannot even load the work
            results = [_lost(error)] + [Result("undone")] * (len(parcel) - 1)
        twins = self._twins.pop(parcel[0].key or "", [])
        for entry, result in zip(parcel, results, strict=True):
            self._tell(entry, result)
        for node in twins:
            self._tell(self.schedule.entries[node], _twin(results[0]))

    def _send(self, entry: Entry) -> None:
        parcel = self.schedule.send(entry)
        number = next(self._numbers)
        self._parcels[number] = parcel
        self._twins[entry.key or ""] = []
        for member in parcel:
            self.watch.start(member)
        steps = _steps(self.schedule, parcel)
        name = f"{entry.node.task}-{'-'.join(map(str, entry.node.at))}-{(entry.key or '')[:8]}-{number}"
        future = self.launch.submit(name, self.schedule.store.url, steps)
        self.out[number] = future
        future.add_done_callback(partial(self._note, number))

    def _note(self, number: int, future: Future) -> None:
        """Called from whatever thread the executor likes."""
        self._done.put((number, future))

    def _tell(self, entry: Entry, result: Result) -> None:
        schedule = self.schedule
        if result.status in ("ran", "fresh"):
            if entry.state in DONE:
                return
            before = len(schedule.entries)
            fresh = schedule.complete(entry.node, result.key, result.artifact, result.record, ran=result.status == "ran")
            if len(schedule.entries) != before:
                self.watch.layout(schedule.entries.values())
            self.watch.finish(entry, result)
            self.watch.fresh(fresh)
        elif result.status == "failed":
            skipped = schedule.fail(entry.node, result.message)
            self.watch.fail(entry, result, [schedule.entries[n] for n in skipped])
        elif result.status == "damaged":
            self._mend(entry, result)
        elif result.status == "undone":
            schedule.put_back(entry.node)
        else:
            raise (StoreFullError if result.error == "StoreFullError" else _refusal(result))(result.message)

    def _mend(self, entry: Entry, result: Result) -> None:
        """An input could not be read: whoever made it makes it again, then this node runs."""
        redone = self.schedule.mend(entry.node, result.artifact, result.message)
        if redone is None:
            told = f"artifact {result.artifact[:12]} {result.message}, again after it was computed again; check the disk"
            self._tell(entry, Result("failed", error="DamagedArtifactError", message=told))
            return
        for maker, was in redone:
            self.watch.damaged(maker, was, result.message)


def _refuse_rings(schedule: Schedule) -> None:
    """A traversal that some artifact orders in a ring leaves nodes that wait for themselves."""
    left = [entry for entry in schedule.entries.values() if entry.state == "waits"]
    if left:
        raise GraphError(
            f"{len(left)} nodes wait for each other, {left[0].label} ({left[0].task.where}) among them: the traversal that"
            f" {left[0].task.along.__name__ if left[0].task.along else 'an artifact above'} orders goes in a ring"
        )


def _on_client(client: Any) -> Launcher:
    from kinetree.pipeline import clusters

    run = secrets.token_hex(8)  # two runs on one scheduler never take each other's results

    def submit(name: str, url: str, steps: tuple[Step, ...]) -> Future:
        future: Future = client.submit(execute, url, steps, key=f"{name}-{run}", pure=False)
        return future

    return Launcher(submit, 3 * clusters.slots(client))


def _steps(schedule: Schedule, parcel: list[Entry]) -> tuple[Step, ...]:
    place = {entry.node: number for number, entry in enumerate(parcel)}
    return tuple(
        Step(
            label=entry.label,
            task=f"{entry.task.module}:{entry.task.name}",
            index=dict(zip(entry.task.over, entry.node.at, strict=True)),
            code=schedule.code[entry.node.task],
            params=schedule.params.get(entry.node.task, {}),
            inputs=tuple(
                Input(a.name, a.form, tuple(_ref(schedule, place, n) for n in nodes), schedule.numbers(entry, a, nodes))
                for a, nodes in entry.inputs or ()
            ),
            key=entry.key if entry is parcel[0] else None,
            force=entry.node.task in schedule.force or any(r.kind == "artifact" for r in entry.reasons),
            distrusted=schedule.distrusted,
        )
        for entry in parcel
    )


def _ref(schedule: Schedule, place: dict[Node, int], node: Node) -> Ref:
    entry = schedule.entries[node]
    if node in place:
        return Ref(entry.label, step=place[node])
    if entry.task.is_origin:
        return Ref(entry.label, given=schedule.given[node.task][node.at])
    return Ref(entry.label, artifact=entry.artifact)


def _lost(error: Exception) -> Result:
    told = f"the worker was lost ({type(error).__name__}: {error}); perhaps it ran out of memory"
    return Result("failed", error=type(error).__name__, message=told)


def _twin(result: Result) -> Result:
    """What became of a node whose twin was computed: the same, without having run."""
    return Result("fresh", result.key, result.artifact, 0.0, result.record) if result.status == "ran" else result


def _refusal(result: Result) -> type[InputError]:
    return StoreError if result.error == "StoreError" else ClusterError
