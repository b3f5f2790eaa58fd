"""One run over a data set: sequences begun one after the other, each put on record, and what became of all of them.

Of the sequences that are open one is always the longest that is left, the others are the shortest: long ones begin early, and
no short one stands behind a long one. How long a sequence is, is told by the bytes of its input.
"""

import contextlib
import glob
import os
import time
import traceback
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Literal

from kinetree.errors import ClusterError, DamagedArtifactError, GraphError, InputError, StoreError, StoreFullError
from kinetree.pipeline.dataset.lease import Leases, holder
from kinetree.pipeline.graph import AnyTask
from kinetree.pipeline.inspect import Pipeline
from kinetree.pipeline.inspection.history import Heads, History
from kinetree.pipeline.inspection.snapshot import Snapshot
from kinetree.pipeline.node import Node
from kinetree.pipeline.output.outcome import OUTCOME, Ending, Outcome, computing_seconds, stamps
from kinetree.pipeline.output.ownership import Owned
from kinetree.pipeline.output.session import Session
from kinetree.pipeline.planning.entry import DONE
from kinetree.pipeline.running.events import Listener
from kinetree.pipeline.running.jobs import Job
from kinetree.pipeline.storage.files import Files
from kinetree.pipeline.storage.store import artifact_path

State = Literal["fresh", "ran", "failed", "elsewhere", "left"]
"""What a run did with a sequence; elsewhere: another process is at it; left: the time was over before it was done."""


@dataclass(frozen=True)
class Named:
    """Tells a listener of which sequence it hears."""

    name: str
    listener: Listener

    def hear(self, event: dict[str, Any]) -> None:
        """Passes the event on with the sequence's name."""
        self.listener.hear({"name": self.name, **event})


@dataclass
class _Open:
    name: str
    pipeline: Pipeline
    session: Session
    mark: str
    is_longest: bool


@dataclass
class Night:
    """The sequences of one run, as the loop takes them."""

    pipelines: dict[str, Pipeline]
    """Those that are asked for, by name."""
    inputs: dict[str, str]
    linked: Sequence[AnyTask]
    """Tasks of the summary's graph whose artifacts the sequences make."""
    leases: Leases
    listeners: Sequence[Listener] = ()
    is_over: Callable[[], bool] = lambda: False
    """Whether the time is over: no node is sent any more."""
    states: dict[str, State] = field(default_factory=dict)
    outcomes: dict[str, Outcome] = field(default_factory=dict)
    reasons: dict[str, str] = field(default_factory=dict)
    """Who is at a sequence elsewhere."""
    _line: deque[str] = field(default_factory=deque)
    _open: dict[Job, _Open] = field(default_factory=dict)
    _back: list[Job] = field(default_factory=list)

    def __post_init__(self) -> None:
        sizes = {name: input_bytes(path) for name, path in self.inputs.items() if name in self.pipelines}
        self._line.extend(sorted(sizes, key=lambda name: (sizes[name], name)))
        self.states.update(dict.fromkeys(self._line, "left"))
        if self.pipelines:
            store = next(iter(self.pipelines.values())).store
            self._files, self._heads = Files.of(store), Heads(store)

    def begin(self) -> Job | None:
        """The next sequence that has something to compute; those that have nothing are dealt with at once."""
        if self._back:
            return self._back.pop()
        while self._line and not self.is_over():
            is_longest = not any(job.is_longest for job in self._open.values())
            name = self._line.pop() if is_longest else self._line.popleft()
            job = self._begun(name, is_longest=is_longest)
            if job is not None:
                return job
        return None

    def put_back(self, job: Job) -> None:
        """A job that was begun is to be given out again."""
        self._back.append(job)

    def end(self, job: Job) -> None:
        """Leaves the results of a sequence and puts on record what became of it."""
        one = self._open.pop(job)
        session, status, failures = one.session, "stopped", list[dict[str, str]]()
        try:
            status = session.leave()
        except (DamagedArtifactError, StoreError) as error:
            if isinstance(error, StoreFullError):
                raise
            failures.append(_failure(error))
            status = "failed"
        finally:
            summed = session.close(status)  # type: ignore[arg-type]
        session.write_pages(summed)
        self._conclude(one, "done" if status == "done" else "failed", failures)

    def may_send(self) -> bool:
        """While there is time."""
        return not self.is_over()

    def give_up(self, status: Ending) -> None:
        """Puts on record that the sequences under way were not finished, and gives all leases back."""
        for one in list(self._open.values()):
            with contextlib.suppress(StoreError):  # which may be why they are given up
                one.session.close(status)
                self._conclude(one, status, [])
        self._open.clear()

    def save(self) -> None:
        """Keeps what was learnt of the user's files."""
        if self.pipelines:
            self._files.save()

    def _begun(self, name: str, *, is_longest: bool) -> Job | None:
        pipeline = self.pipelines[name]
        folder, started = pipeline.config.output, time.perf_counter()
        try:
            if not self.leases.take(folder):
                by = holder(folder) or {}
                self.states[name] = "elsewhere"
                self.reasons[name] = f"process {by.get('pid', '?')} on {by.get('host', '?')} is at it"
                return None
            pipeline.store.records.look_again()
            history = History.of(pipeline.store, pipeline.config, self._heads)
            outside, before = pipeline.look_outside(self._files, history), Outcome.at(folder)
            mark = pipeline.mark(outside)
            is_whole = before is not None and before.is_done and before.is_untouched(folder) and self._holds(before)
            if before is not None and is_whole and before.mark == mark:
                self._settle(name, "fresh", before)
                return None
            there = pipeline.look(self._files, history, pipeline.tasks.unasked, outside=outside)
            session = Session.begin(
                pipeline.config,
                there,
                [Named(name, listener) for listener in self.listeners],
                started=started,
                told_of=pipeline.described(),
            )
        except (StoreFullError, ClusterError, GraphError):
            raise
        except Exception as error:  # whatever is wrong with one sequence is no other's concern
            if isinstance(error, StoreError) and not _is_output_of(error, folder):
                raise
            self._refuse(name, error)
            return None
        job = Job(there.schedule, session.watch)
        self._open[job] = _Open(name, pipeline, session, mark, is_longest)
        if job.is_idle:
            self.end(job)
            return None
        return job

    def _holds(self, outcome: Outcome) -> bool:
        """Whether what the summary reads of a sequence is still in the store."""
        place = next(iter(self.pipelines.values())).store.place
        return all(place.size(artifact_path(digest)) is not None for digest in outcome.artifacts.values())

    def _refuse(self, name: str, error: Exception) -> None:
        """The input of a sequence is wrong, or its folder cannot be written."""
        config = self.pipelines[name].config
        failure = {**_failure(error), "trace": "" if isinstance(error, InputError) else traceback.format_exc()}
        for listener in self.listeners:
            Named(name, listener).hear({"event": "refused", "time": round(time.time(), 3), **failure})
        outcome = Outcome(name, self.inputs[name], "failed", now(), failures=(_failure(error),))
        try:
            Owned.of(config.output).claim([OUTCOME])
            outcome.write(config.output)
        except StoreFullError:
            raise
        except StoreError:
            pass  # the folder itself may be what is wrong
        self._settle(name, "failed", outcome)

    def _conclude(self, one: _Open, status: Ending, failures: Iterable[dict[str, str]]) -> None:
        session, config = one.session, one.pipeline.config
        schedule = session.there.schedule
        counts = session.account.nodes()
        known = [{key: f[key] for key in ("node", "error", "message")} for f in session.account.failures]
        is_done = status == "done"
        outcome = Outcome(
            one.name,
            self.inputs[one.name],
            status,
            now(),
            session.name,
            computing_seconds(schedule),
            sum(len(artifacts) for artifacts in schedule.origin_artifacts.values()),
            counts,
            (*known, *failures),
            _remarks(session.there) if is_done else (),
            one.mark,
            _artifacts(one.pipeline, schedule, self.linked) if is_done else {},
            stamps(config.output, session.left) if is_done else {},
        )
        session.owned.claim([OUTCOME])
        outcome.write(config.output)
        state: State = "failed" if status == "failed" else "left" if not is_done else "ran" if counts["ran"] else "fresh"
        self._settle(one.name, state, outcome)

    def _settle(self, name: str, state: State, outcome: Outcome) -> None:
        self.states[name], self.outcomes[name] = state, outcome
        self.leases.give_back(self.pipelines[name].config.output)


def now() -> str:
    """The time in UTC, to the second."""
    return datetime.now(UTC).isoformat(timespec="seconds")


def input_bytes(path: str) -> int:
    """Bytes of the files at a path, in a folder or of a pattern; 0 where none is to be seen from here."""
    return sum(stat.st_size for stat in _stats(path))


def input_changed(path: str) -> float:
    """When a file at a path, in a folder or of a pattern was last changed, in seconds since the epoch."""
    return max((max(stat.st_mtime, stat.st_ctime) for stat in _stats(path)), default=0.0)


def _stats(path: str) -> list[os.stat_result]:
    if "://" in path:
        return []
    tops = [Path(path)] if Path(path).exists() else [Path(p) for p in glob.glob(path, recursive=True)]  # noqa: PTH207
    try:
        return [file.stat() for top in tops for file in (top.rglob("*") if top.is_dir() else (top,)) if file.is_file()]
    except OSError:
        return []


def _remarks(there: Snapshot) -> tuple[str, ...]:
    try:
        return tuple(f"{node}: {text}" for node, text in there.remarks())
    except DamagedArtifactError:
        return ()


def _artifacts(pipeline: Pipeline, schedule: Any, linked: Sequence[AnyTask]) -> dict[str, str]:
    """What this sequence made of that which the summary reads, by the summary's tasks."""
    digests: dict[str, str] = {}
    for task in linked:
        writer = pipeline.tasks.writers.get(task.returns)
        entry = schedule.entries.get(Node(writer.name, ())) if writer is not None else None
        if entry is not None and entry.state in DONE:
            digests[task.name] = str(entry.artifact)
    return digests


def _failure(error: Exception) -> dict[str, str]:
    return {"node": "", "error": type(error).__name__, "message": str(error) or type(error).__name__}


def _is_output_of(error: StoreError, folder: Path) -> bool:
    """Whether it is the sequence's own folder that cannot be used, and not the store."""
    return str(folder) in str(error) and "output folder" in str(error)
