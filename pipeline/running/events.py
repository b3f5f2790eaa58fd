"""What happens during a run, told to whoever listens: the terminal, a log of JSON lines, the run's own account."""

import json
import time
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol, TextIO

from kinetree.pipeline.planning.entry import Entry, State
from kinetree.pipeline.running.execute import Result


class Listener(Protocol):
    """Hears every event of a run as a dictionary with at least "event" and "time"."""

    def hear(self, event: dict[str, Any]) -> None:
        """One event."""


@dataclass
class Watch:
    """Turns what the run loop does into events."""

    listeners: Sequence[Listener] = field(default_factory=tuple)

    def begin(self, run: str, nodes: Iterable[Entry]) -> None:
        """A run begins; nodes that are fresh already are told as such."""
        entries = list(nodes)
        self._tell("run", run=run, nodes=len(entries))
        self.layout(entries)
        self.fresh(e for e in entries if e.state == "fresh" and not e.task.is_origin)

    def dashboard(self, link: str) -> None:
        """Dask shows what its workers do on a page."""
        self._tell("dashboard", link=link)

    def layout(self, nodes: Iterable[Entry]) -> None:
        """More of the graph is known: how many nodes each task has by now."""
        self._tell("layout", totals=dict(Counter(e.node.task for e in nodes if not e.task.is_origin)))

    def start(self, entry: Entry) -> None:
        """A node was sent to a worker."""
        self._tell("start", node=entry.label, task=entry.node.task, why=[str(r) for r in entry.reasons])

    def finish(self, entry: Entry, result: Result) -> None:
        """A node has its artifact, computed or found."""
        peak = result.record.peak_bytes if result.record else 0
        if result.status == "ran":
            measured = {"seconds": round(result.seconds, 6), "peak_bytes": peak, "artifact": result.artifact}
            self._tell("finish", node=entry.label, task=entry.node.task, **measured)
        else:
            self.fresh([entry])

    def fresh(self, entries: Iterable[Entry]) -> None:
        """Nodes turned out to be fresh when their inputs were known."""
        for entry in entries:
            self._tell("fresh", node=entry.label, task=entry.node.task)

    def fail(self, entry: Entry, result: Result, skipped: Iterable[Entry]) -> None:
        """A node failed, and those below it are skipped."""
        cause = {"error": result.error, "message": result.message, "seconds": round(result.seconds, 6), "trace": result.trace}
        self._tell("failed", node=entry.label, task=entry.node.task, **cause)
        self.skip(skipped)

    def skip(self, entries: Iterable[Entry]) -> None:
        """Nodes do not run, since one that they read failed."""
        for entry in entries:
            self._tell("skipped", node=entry.label, task=entry.node.task, because=entry.cause)

    def damaged(self, entry: Entry, was: State, what: str) -> None:
        """The artifact of a node that was done lost bytes: what was told of the node is taken back, it runs again."""
        self._tell("damaged", node=entry.label, task=entry.node.task, was=was, what=what)

    def end(self, status: str, seconds: float) -> None:
        """The run is over."""
        self._tell("end", status=status, seconds=round(seconds, 3))

    def _tell(self, event: str, **rest: Any) -> None:
        message = {"event": event, "time": round(time.time(), 3), **rest}
        for listener in self.listeners:
            listener.hear(message)


@dataclass
class JsonLog:
    """One event a line."""

    out: TextIO

    def hear(self, event: dict[str, Any]) -> None:
        """Writes and flushes, so that a reader sees it at once."""
        self.out.write(json.dumps(event, ensure_ascii=False) + "\n")
        self.out.flush()


@dataclass
class Account:
    """What ran, what was fresh, what failed: the counts of run.json."""

    tasks: dict[str, dict[str, Any]] = field(default_factory=dict)
    failures: list[dict[str, str]] = field(default_factory=list)
    skipped: int = 0

    def hear(self, event: dict[str, Any]) -> None:
        """Counts the event."""
        kind = event["event"]
        if kind == "skipped":
            self.skipped += 1
        if kind == "damaged":
            self.tasks[event["task"]][event["was"]] -= 1
        if kind not in ("fresh", "finish", "failed"):
            return
        row = self.tasks.setdefault(event["task"], {"ran": 0, "fresh": 0, "failed": 0, "seconds": 0.0, "peak_bytes": 0})
        row[{"finish": "ran"}.get(kind, kind)] += 1
        row["seconds"] = round(row["seconds"] + event.get("seconds", 0.0), 6)
        row["peak_bytes"] = max(row["peak_bytes"], event.get("peak_bytes", 0))
        if kind == "failed":
            self.failures.append({name: event[name] for name in ("node", "error", "message", "trace")})

    def nodes(self) -> dict[str, int]:
        """Total counts."""
        counts = {kind: sum(row[kind] for row in self.tasks.values()) for kind in ("ran", "fresh", "failed")}
        return {**counts, "skipped": self.skipped}
