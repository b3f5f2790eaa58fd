"""Runs a schedule until nothing is left to run: parcels out, results in, the schedule told."""

import contextlib
import itertools
import queue
import signal
import threading
import time
from collections import Counter, deque
from collections.abc import Iterator
from concurrent.futures import CancelledError
from dataclasses import dataclass, field
from functools import partial

from kinetree.errors import ClusterError, GraphError, KinetreeError, LostWorkerError, StoreError, StoreFullError
from kinetree.pipeline import sight as seeing
from kinetree.pipeline.entry import DONE, Entry
from kinetree.pipeline.events import Watch
from kinetree.pipeline.execute import Result, forget_reads
from kinetree.pipeline.launch import Future, Launcher
from kinetree.pipeline.node import Node
from kinetree.pipeline.parcels import steps_of
from kinetree.pipeline.schedule import Schedule
from kinetree.pipeline.sight import Sight

LOOK_AGAIN = 0.1
"""Seconds after which the run looks for new workers, and again for a record that was not there."""


def run(schedule: Schedule, launch: Launcher, watch: Watch) -> None:
    """Runs until every node is done, failed or skipped.

    raises : StoreError, ClusterError where going on makes no sense; KeyboardInterrupt; either way the store is whole
    """
    forget_reads()
    if launch.dashboard:
        watch.dashboard(launch.dashboard)
    loop = _Loop(schedule, launch, watch, Sight.of(schedule.store))
    try:
        with _interruptible(loop):
            loop.go()
            while loop.take_back_lost():
                loop.go()
        _refuse_rings(schedule)
    except BaseException:
        for future in loop.out.values():
            future.cancel()
        loop.out.clear()
        raise
    finally:
        loop.sight.end(schedule.store)


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
    sight: Sight
    out: dict[int, Future] = field(default_factory=dict)
    _parcels: dict[int, list[Entry]] = field(default_factory=dict)
    _done: "queue.SimpleQueue[tuple[int, Future | None]]" = field(default_factory=queue.SimpleQueue)
    _twins: dict[str, list[Node]] = field(default_factory=dict)
    """Nodes that wait for a parcel under way which computes the same key."""
    _numbers: Iterator[int] = field(default_factory=itertools.count)
    _suspects: "deque[Entry]" = field(default_factory=deque)
    """Nodes whose workers died; each is tried again when nothing else is out."""
    _lost: "Counter[Node]" = field(default_factory=Counter)
    _look_at: float = 0.0
    _unseen: dict[int, float] = field(default_factory=dict)
    """Since when the results of a parcel are looked for in the store."""

    def go(self) -> None:
        """Sends and receives until nothing is ready and nothing out."""
        while self.send() or self.out:
            self.receive()

    def take_back_lost(self) -> bool:
        """What somebody removed from the store after it was seen there is computed again; True if there was any."""
        done = [e for e in self.schedule.entries.values() if e.state in DONE and not e.task.is_origin]
        lost = seeing.missing(self.schedule.store, {(e.key or "", e.artifact or "") for e in done})
        for entry in done:
            if (entry.key, entry.artifact) in lost:
                self.schedule.lose(entry, "it is missing")
        self._tell_losses()
        return bool(lost)

    def send(self) -> bool:
        """Sends ready nodes while the window has room; True if any went."""
        sent = False
        for entry in self.schedule.ready() if len(self.out) < self.launch.window() else ():
            if entry.key in self._twins:
                self._twins[entry.key].append(entry.node)
                continue
            self._send(entry)
            sent = True
            if len(self.out) >= self.launch.window():
                break
        if self._suspects and not self.out:
            self._submit([self._suspects.popleft()])
            return True
        return sent

    def interrupt(self, *_: object) -> None:
        """Makes the loop stop at what it receives next; safe to call from a signal's handler."""
        self._done.put((-1, None))

    def receive(self) -> None:
        """Waits for one parcel, for a while, and tells the schedule what became of it."""
        if self.launch.is_elsewhere and time.monotonic() > self._look_at:
            self.sight.confirm(self.schedule.store)
            self.launch.look_after()
            self._look_at = time.monotonic() + LOOK_AGAIN
        try:
            number, future = self._done.get(timeout=LOOK_AGAIN if self.launch.is_elsewhere else None)
        except queue.Empty:
            return
        if future is None:
            raise KeyboardInterrupt
        parcel = self._parcels[number]
        try:
            results: list[Result] = future.result()
        except CancelledError:
            raise ClusterError("the scheduler cancelled the work; was it stopped? Run again to go on") from None
        except Exception as error:  # the workers died under it, or none can even load the work
            self._forget(number)
            self._lose(parcel, error)
            return
        if self._all_seen(number, parcel, results, future):
            self._forget(number)
            self._tell_all(parcel, results)

    def _lose(self, parcel: list[Entry], error: Exception) -> None:
        """Nothing came back of a parcel. Its first node is tried again, alone, since another may have killed its workers."""
        first, *rest = parcel
        for entry in rest:
            self.schedule.put_back(entry.node)
        self._lost[first.node] += 1
        if isinstance(error, LostWorkerError) and self._lost[first.node] <= first.task.retries:
            self._suspects.append(first)
        else:
            self._tell_all([first], [Result("failed", error=type(error).__name__, message=str(error) or repr(error))])

    def _tell_all(self, parcel: list[Entry], results: list[Result]) -> None:
        twins = self._twins.pop(parcel[0].key or "", [])
        for entry, result in zip(parcel, results, strict=True):
            self._tell(entry, result)
        for node in twins:
            self._tell(self.schedule.entries[node], _twin(results[0]))

    def _all_seen(self, number: int, parcel: list[Entry], results: list[Result], future: Future) -> bool:
        """Whether what a worker says it stored is there for this process too; where not, it is looked for again soon.

        raises : StoreError where it was not there for too long
        """
        for entry, result in zip(parcel, results, strict=True):
            is_stored = result.status in ("ran", "fresh")
            if is_stored and not seeing.sees(self.schedule.store, result.key, result.artifact):
                since = self._unseen.setdefault(number, time.monotonic())
                if time.monotonic() - since > seeing.SEEN_WITHIN:
                    raise seeing.unseen(self.schedule.store, entry.label, result.record)
                later = threading.Timer(LOOK_AGAIN, self._note, (number, future))
                later.daemon = True
                later.start()
                return False
        return True

    def _forget(self, number: int) -> None:
        del self.out[number], self._parcels[number]
        self._unseen.pop(number, None)

    def _send(self, entry: Entry) -> None:
        parcel = self.schedule.send(entry)
        self._twins[entry.key or ""] = []
        for member in parcel:
            self.watch.start(member)
        self._submit(parcel)

    def _submit(self, parcel: list[Entry]) -> None:
        number, first = next(self._numbers), parcel[0]
        tasks = "+".join(dict.fromkeys(entry.node.task for entry in parcel))
        name = f"{tasks}-{'-'.join(map(str, first.node.at))}-{(first.key or '')[:8]}-{number}"
        future = self.launch.submit(name, self.schedule.store.url, steps_of(self.schedule, parcel), self.sight)
        self._parcels[number] = parcel
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
            self._tell_losses()
        elif result.status == "failed":
            skipped = schedule.fail(entry.node, result.message)
            self.watch.fail(entry, result, [schedule.entries[n] for n in skipped])
        elif result.status == "damaged":
            self._mend(entry, result)
        elif result.status == "undone":
            schedule.put_back(entry.node)
        else:
            raise (StoreFullError if result.error == "StoreFullError" else _refusal(result))(result.message)

    def _tell_losses(self) -> None:
        """What could not be read while more of the graph was laid out, or was not there in the end."""
        for loss in self.schedule.losses():
            self.watch.damaged(loss.entry, loss.was, loss.what)
            if loss.skipped is not None:
                failed = _beyond_repair(loss.entry.artifact or "", loss.what)
                self.watch.fail(loss.entry, failed, [self.schedule.entries[n] for n in loss.skipped])

    def _mend(self, entry: Entry, result: Result) -> None:
        """An input could not be read: whoever made it makes it again, then this node runs."""
        redone = self.schedule.mend(entry.node, result.artifact, result.message)
        if redone is None:
            self._tell(entry, _beyond_repair(result.artifact, result.message))
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


def _beyond_repair(artifact: str, what: str) -> Result:
    told = f"artifact {artifact[:12]} {what}, again after it was computed again; check the disk"
    return Result("failed", error="DamagedArtifactError", message=told)


def _twin(result: Result) -> Result:
    """What became of a node whose twin was computed: the same, without having run."""
    return Result("fresh", result.key, result.artifact, 0.0, result.record) if result.status == "ran" else result


def _refusal(result: Result) -> type[KinetreeError]:
    return StoreError if result.error == "StoreError" else ClusterError
