"""Progress for people: live rows per task on a terminal, plain lines elsewhere."""

import time
from dataclasses import dataclass, field
from typing import Any

from rich.console import Console
from rich.live import Live
from rich.table import Table

from kinetree.pipeline.command_line.printable import printable

PLAIN_SECONDS = 5.0


@dataclass
class Row:
    """What is known of one task while the run is under way."""

    ran: int = 0
    fresh: int = 0
    failed: int = 0
    skipped: int = 0
    running: int = 0
    total: int = 0
    seconds: float = 0.0

    def hear(self, kind: str, seconds: float) -> None:
        """Counts an event."""
        if kind == "start":
            self.running += 1
        elif kind in ("finish", "failed"):
            self.running = max(0, self.running - 1)
            self.ran += kind == "finish"
            self.failed += kind == "failed"
            self.seconds += seconds
        elif kind == "fresh":
            self.fresh += 1
            self.running = max(0, self.running - 1)
        elif kind == "skipped":
            self.skipped += 1

    @property
    def done(self) -> int:
        """Nodes that are finished, whether computed, up to date, failed or skipped."""
        return self.ran + self.fresh + self.failed + self.skipped


@dataclass
class Rows:
    """The rows of all tasks; time left is an estimate from the mean of what ran so far."""

    workers: int
    rows: dict[str, Row] = field(default_factory=dict)

    def hear(self, event: dict[str, Any]) -> None:
        """Counts an event."""
        if event["event"] == "layout":
            for task, total in event["totals"].items():
                self.rows.setdefault(task, Row()).total = total
        elif "task" in event:
            row = self.rows.setdefault(event["task"], Row())
            row.hear(event["event"], event.get("seconds", 0.0))
            if event["event"] == "damaged":
                row.ran -= event["was"] == "ran"
                row.fresh -= event["was"] == "fresh"

    def seconds_left(self, row: Row) -> float | None:
        """Seconds until a task is finished, from the mean of its nodes so far; None while none ran."""
        todo = row.total - row.done
        return todo * row.seconds / row.ran / self.workers if row.ran and todo else (0.0 if not todo else None)


class LiveProgress:
    """Rows that redraw themselves on a terminal; a context, so that the terminal is whole afterwards."""

    def __init__(self, console: Console, workers: int) -> None:
        self._rows = Rows(workers)
        self._live = Live(console=console, refresh_per_second=8, get_renderable=self._table, transient=False)

    def __enter__(self) -> "LiveProgress":
        self._live.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._live.stop()

    def hear(self, event: dict[str, Any]) -> None:
        """Counts an event; the table redraws itself."""
        if event["event"] == "dashboard":
            self._live.console.print(f"dashboard: {event['link']}", markup=False, highlight=False, soft_wrap=True)
        self._rows.hear(event)

    def _table(self) -> Table:
        table = Table(box=None, pad_edge=False, header_style="bold")
        table.add_column("task")
        for name in ("done", "fresh", "failed", "time left"):
            table.add_column(name, justify="right")
        for name, row in self._rows.rows.items():
            seconds_left = self._rows.seconds_left(row)
            time_left = "" if row.total == row.done else ("…" if seconds_left is None else clock(seconds_left))
            failed = f"[red]{row.failed + row.skipped}[/red]" if row.failed + row.skipped else ""
            table.add_row(name, f"{row.done}/{row.total}", str(row.fresh or ""), failed, time_left)
        return table


class PlainProgress:
    """A line when a task is finished, when something fails, and every few seconds in between."""

    def __init__(self, console: Console, workers: int) -> None:
        self._console = console
        self._rows = Rows(workers)
        self._last_line = time.monotonic()

    def __enter__(self) -> "PlainProgress":
        return self

    def __exit__(self, *_: object) -> None:
        return None

    def hear(self, event: dict[str, Any]) -> None:
        """Counts an event and prints what is worth a line."""
        self._rows.hear(event)
        if event["event"] == "dashboard":
            self._say(f"dashboard: {event['link']}")
        if event["event"] == "failed":
            self._say(f"{event['node']}: failed: {event['message']}")
        if event["event"] == "finish":
            row = self._rows.rows[event["task"]]
            if row.done == row.total:
                self._say(f"{event['task']}: {row.ran} ran, {row.fresh} fresh, {row.seconds:.1f} s")
            elif time.monotonic() - self._last_line > PLAIN_SECONDS:
                seconds = self._rows.seconds_left(row)
                self._say(f"{event['task']}: {row.done} of {row.total}{f', {clock(seconds)} left' if seconds else ''}")

    def _say(self, line: str) -> None:
        self._last_line = time.monotonic()
        self._console.print(printable(line), markup=False, highlight=False, soft_wrap=True)


def clock(seconds: float) -> str:
    """A duration a person reads at a glance: 8 s, 3:20, 1:05:00."""
    whole = round(seconds)
    if whole < 60:
        return f"{seconds:.1f} s" if seconds < 10 else f"{whole} s"
    minutes, rest = divmod(whole, 60)
    return f"{minutes}:{rest:02d}" if minutes < 60 else f"{minutes // 60}:{minutes % 60:02d}:{rest:02d}"
