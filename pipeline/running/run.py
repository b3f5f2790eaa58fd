"""Runs schedules until nothing is left to run: parcels out, results in, the schedules told."""

import itertools
import queue
import threading
import time
from collections.abc import Iterator
from concurrent.futures import CancelledError
from dataclasses import dataclass, field
from functools import partial

from kinetree.errors import ClusterError, LateNodeError
from kinetree.pipeline.graph_cache import import_functions
from kinetree.pipeline.node import Node
from kinetree.pipeline.planning.entry import Entry
from kinetree.pipeline.planning.schedule import Schedule
from kinetree.pipeline.running import sight as seeing
from kinetree.pipeline.running.events import Watch
from kinetree.pipeline.running.execute import Result, forget_reads
from kinetree.pipeline.running.fates import refuse_rings, refuse_to_wait_for, twin
from kinetree.pipeline.running.interrupts import interruptible
from kinetree.pipeline.running.jobs import OPEN_AT_LEAST, Job, Jobs, Single, fairest
from kinetree.pipeline.running.launch import Future, Launcher
from kinetree.pipeline.running.losses import take_back_lost
from kinetree.pipeline.running.memory import Needs
from kinetree.pipeline.running.parcels import Demand, steps_of
from kinetree.pipeline.running.sight import Sight
from kinetree.pipeline.running.suspects import Suspects, finished
from kinetree.pipeline.running.telling import tell
from kinetree.pipeline.storage.store import Store

LOOK_AGAIN = 0.1
"""Seconds after which the run looks for new workers, and again for a record that was not there."""


def run(schedule: Schedule, launch: Launcher, watch: Watch, needs: Needs | None = None) -> None:
    """Runs one schedule until every node is done, failed or skipped; raises as `run_all`."""
    if launch.dashboard:
        watch.dashboard(launch.dashboard)
    run_all(Single(Job(schedule, watch, needs or Needs())), schedule.store, launch)


def run_all(jobs: Jobs, store: Store, launch: Launcher) -> None:
    """Runs schedules over one store in one window until there are no more.

    raises : StoreError, ClusterError where going on makes no sense; KeyboardInterrupt; either way the store is whole
    """
    forget_reads()
    loop = _Loop(jobs, store, launch, Sight.of(store))
    try:
        with interruptible(loop.interrupt, is_apart=launch.is_apart):
            while loop.send() or loop.out:
                loop.receive()
    except BaseException:
        for future in loop.out.values():
            future.cancel()
        loop.out.clear()
        raise
    finally:
        loop.sight.end(store)


@dataclass
class _Loop:
    jobs: Jobs
    store: Store
    launch: Launcher
    sight: Sight
    out: dict[int, Future] = field(default_factory=dict)
    _open: list[Job] = field(default_factory=list)
    _parcels: dict[int, tuple[Job, list[Entry]]] = field(default_factory=dict)
    _done: "queue.SimpleQueue[tuple[int, Future | None]]" = field(default_factory=queue.SimpleQueue)
    _twins: dict[str, list[tuple[Job, Node]]] = field(default_factory=dict)
    """Nodes that wait for a parcel under way which computes the same key."""
    _numbers: Iterator[int] = field(default_factory=itertools.count)
    _limits: dict[int, float] = field(default_factory=dict)
    """Seconds that a parcel may take."""
    _suspects: Suspects = field(default_factory=Suspects)
    _look_at: float = 0.0
    _unseen: dict[int, float] = field(default_factory=dict)
    """Since when the results of a parcel are looked for in the store."""

    def send(self) -> bool:
        """Sends ready nodes while the window has room; True if any went."""
        sent = False
        self._end_jobs()
        while len(self.out) < self.launch.window() and self.jobs.may_send():
            self._begin_jobs()
            job = fairest(self._open)
            if job is None:
                break
            entry = next(job.schedule.ready())
            job.out += 1
            if entry.key in self._twins:
                self._twins[entry.key].append((job, entry.node))
                continue
            self._twins[entry.key or ""] = []
            if self._suspects.losses(job, entry):
                self._suspects.waiting += [(job, member) for member in job.schedule.send(entry, is_alone=True)]
                continue
            self._send(job, entry)
            sent = True
        if self._suspects.waiting and not self.out:
            job, entry = self._suspects.waiting.popleft()
            self._submit(job, [entry])
            return True
        return sent

    def _end_jobs(self) -> None:
        for job in [job for job in self._open if job.is_over]:
            while take_back_lost(job, self.store) and job.is_over:
                pass  # what was lost too often has failed by now
            if job.is_over:
                self._open.remove(job)
                refuse_rings(job.schedule)
                self.jobs.end(job)

    def _begin_jobs(self) -> None:
        """Begins schedules until enough are open and some node is ready, or there is none to begin."""
        while len(self._open) < OPEN_AT_LEAST or fairest(self._open) is None:
            begun = self.jobs.begin()
            if begun is None:
                return
            if not self.launch.is_elsewhere:
                import_functions(begun.schedule.graph)
            self._open.append(begun)
            self._end_jobs()

    def interrupt(self, *_: object) -> None:
        """Makes the loop stop at what it receives next; safe to call from a signal's handler."""
        self._done.put((-1, None))

    def receive(self) -> None:
        """Waits for one parcel, for a while, and tells the schedule what became of it."""
        if self.launch.is_elsewhere and time.monotonic() > self._look_at:
            self.sight.confirm(self.store)
            self.launch.look_after()
            self._look_at = time.monotonic() + LOOK_AGAIN
        if self._give_up_late():
            return
        try:
            number, future = self._done.get(timeout=LOOK_AGAIN if self.launch.is_elsewhere or self._limits else None)
        except queue.Empty:
            return
        if future is None:
            raise KeyboardInterrupt
        if number not in self._parcels:  # given up meanwhile
            return
        job, parcel = self._parcels[number]
        try:
            results: list[Result] = future.result()
        except CancelledError:
            raise ClusterError("the scheduler lost the work; was it stopped or started anew? Run again to go on") from None
        except ClusterError:
            raise
        except Exception as error:  # the workers died under it, or none can even load the work
            self._forget(number)
            self._lose(job, parcel, error)
            return
        if self._all_seen(number, parcel, results, future):
            self._forget(number)
            self._tell_all(job, parcel, results)

    def _give_up_late(self) -> bool:
        """Nobody waits any longer for nodes that take longer than their task allows; True if there was any."""
        late, given_up = [(n, limit) for n, limit in self._limits.items() if self.out[n].seconds() > limit], False
        for number, limit in late:
            future = self.out[number]
            job, parcel = self._parcels[number]
            refuse_to_wait_for(parcel[0], limit, is_elsewhere=self.launch.is_elsewhere)
            what = future.give_up()
            if what is None:
                continue
            given_up = True
            self._forget(number)
            tries = self._suspects.losses(job, parcel[0]) + 1
            times = f", each of {tries} times that it was tried" if tries > 1 else ""
            cause = f"it takes longer than the {limit:g} s that its task allows{times}; {what}"
            self._lose(job, parcel, LateNodeError(cause))
        return given_up

    def _lose(self, job: Job, parcel: list[Entry], error: Exception) -> None:
        """Nothing came back of a parcel: what has a record is done, and the first node without one is tried again or fails.

        The first of the parcel counts as under way until something is told of it, so that it waits for its next try, alone. One
        behind it is put back: it is sent again as any other that is ready.
        """
        first, *rest = parcel
        for entry in rest:
            job.schedule.put_back(entry.node)
        failure = Result("failed", error=type(error).__name__, message=str(error) or repr(error))
        known = finished(job, first, self.store)
        if known is None:
            if self._suspects.lose(job, first, rest, error, self.store):
                self._suspects.waiting.append((job, first))
            else:
                self._tell_all(job, [first], [failure])
            return
        self._tell_all(job, [first], [known])  # those behind it settle as far as they have records
        suspect = next((entry for entry in rest if entry.state == "stale"), None)
        if suspect is not None and not self._suspects.lose(job, suspect, rest, error, self.store):
            tell(job, suspect, failure)

    def _tell_all(self, job: Job, parcel: list[Entry], results: list[Result]) -> None:
        twins = self._twins.pop(parcel[0].key or "", [])
        job.out -= 1
        for entry, result in zip(parcel, results, strict=True):
            tell(job, entry, result)
        for other, node in twins:
            other.out -= 1
            tell(other, other.schedule.entries[node], twin(results[0]))

    def _all_seen(self, number: int, parcel: list[Entry], results: list[Result], future: Future) -> bool:
        """Whether what a worker says it stored is there for this process too; where not, it is looked for again soon.

        raises : StoreError where it was not there for too long
        """
        for entry, result in zip(parcel, results, strict=True):
            if result.status in ("ran", "fresh") and not seeing.sees(self.store, result.key, result.artifact):
                since = self._unseen.setdefault(number, time.monotonic())
                if time.monotonic() - since > seeing.SEEN_WITHIN:
                    raise seeing.unseen(self.store, entry.label, result.record)
                later = threading.Timer(LOOK_AGAIN, self._note, (number, future))
                later.daemon = True
                later.start()
                return False
        return True

    def _forget(self, number: int) -> None:
        del self.out[number], self._parcels[number]
        self._unseen.pop(number, None)
        self._limits.pop(number, None)

    def _send(self, job: Job, entry: Entry) -> None:
        parcel = job.schedule.send(entry)
        for member in parcel:
            job.watch.start(member)
        self._submit(job, parcel)

    def _submit(self, job: Job, parcel: list[Entry]) -> None:
        number, first = next(self._numbers), parcel[0]
        tasks = "+".join(dict.fromkeys(entry.node.task for entry in parcel))
        name = f"{tasks}-{'-'.join(map(str, first.node.at))}-{(first.key or '')[:8]}-{number}"
        demand = Demand.of(parcel, job.needs)
        future = self.launch.submit(name, demand, self.store.url, steps_of(job.schedule, parcel), self.sight)
        self._parcels[number] = job, parcel
        self.out[number] = future
        if demand.seconds is not None and self.launch.is_apart:
            self._limits[number] = demand.seconds
        future.add_done_callback(partial(self._note, number))

    def _note(self, number: int, future: Future) -> None:
        """Called from whatever thread the executor likes."""
        self._done.put((number, future))
