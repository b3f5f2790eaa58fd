"""What computing took, from records: by task for what is there, and estimated for what a run would compute."""

from collections import defaultdict
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean
from typing import Any

from kinetree.pipeline.inspection.look import html_table
from kinetree.pipeline.planning.entry import Entry
from kinetree.pipeline.planning.schedule import Schedule
from kinetree.pipeline.storage.store import Record

COLUMNS = ("task", "nodes", "seconds", "mean", "longest", "peak MB", "MB")
MEGABYTE = 1e6


@dataclass(frozen=True)
class Timing:
    """One task: how many of its nodes have a record, and what these took."""

    task: str
    nodes: int
    seconds: float
    longest: float
    peak_bytes: int
    """Largest peak of a process that computed one; other nodes of the same process count in it."""
    bytes: int
    """Bytes of their artifacts in the store."""

    def cells(self) -> tuple[str, ...]:
        """The task's line of a table."""
        seconds = (self.seconds, self.seconds / self.nodes, self.longest)
        sizes = (self.peak_bytes / MEGABYTE, self.bytes / MEGABYTE)
        return (self.task, str(self.nodes), *(f"{s:.2f}" for s in seconds), *(f"{size:.1f}" for size in sizes))


@dataclass(frozen=True)
class Timings:
    """Tasks with at least one record, in the order of the graph."""

    tasks: tuple[Timing, ...]

    @staticmethod
    def of(entries: Iterable[Entry]) -> "Timings":
        """The timings of the nodes that have a record."""
        records: defaultdict[str, list[Record]] = defaultdict(list)
        for entry in entries:
            if entry.record is not None:
                records[entry.node.task].append(entry.record)
        return Timings(tuple(_timing(task, of_task) for task, of_task in records.items()))

    @property
    def seconds(self) -> float:
        """Seconds of all nodes together, as if one ran after the other."""
        return sum(row.seconds for row in self.tasks)

    def json(self) -> list[dict[str, Any]]:
        """One object a task."""
        return [dict(vars(row)) for row in self.tasks]

    def __repr__(self) -> str:
        """A table, one line a task."""
        return "\n".join("  ".join(row) for row in [COLUMNS, *(row.cells() for row in self.tasks)])

    def _repr_html_(self) -> str:
        return html_table(COLUMNS, [row.cells() for row in self.tasks])


@dataclass(frozen=True)
class Estimate:
    """What a run would take on one worker, from what the same nodes or others of the same task took before."""

    seconds: float
    by_task: dict[str, float]
    nodes: int
    """Nodes that are known not to be fresh."""
    waiting: int
    """Those of them that need not run where what they wait for stays as it was; they count as if they ran."""
    unknown: tuple[str, ...]
    """Tasks of which a node would run and none ever did; they count nothing."""
    open_tasks: tuple[str, ...]
    """Tasks that may have more nodes than are known yet; what there was last time counts for these."""

    def json(self) -> dict[str, Any]:
        """The estimate as JSON values."""
        return {**vars(self), "unknown": list(self.unknown), "open_tasks": list(self.open_tasks)}

    def __str__(self) -> str:
        text = f"about {self.seconds:.1f} s of computing for {self.nodes} nodes"
        if self.waiting:
            text += f", {self.waiting} of which run only if what they wait for changes"
        if self.unknown:
            text += f", and what {', '.join(self.unknown)} will take, of which no run is on record"
        return text


def estimated(schedule: Schedule, last: Mapping[str, Record], wanted: Collection[str]) -> Estimate:
    """The estimate of what a schedule has to compute.

    last   : by label, the records of the nodes of the last runs
    wanted : the tasks that count
    """
    means = _means([*last.values(), *(e.record for e in schedule.entries.values() if e.record is not None)])
    todo = [e for e in schedule.entries.values() if e.node.task in wanted and e.state not in ("fresh", "ran")]
    seconds: defaultdict[str, float] = defaultdict(float)
    for entry in todo:
        before = last.get(entry.label)
        seconds[entry.node.task] += before.seconds if before else means.get(entry.node.task, 0.0)
    open_tasks = tuple(task for task, blocking in schedule.blocked.items() if blocking and task in wanted)
    known = {e.label for e in schedule.entries.values()}
    for label, record in last.items():
        if record.task in open_tasks and label not in known:
            seconds[record.task] += record.seconds
    running = {e.node.task for e in todo} | set(open_tasks)
    unknown = tuple(task.name for task in schedule.graph.tasks if task.name in running and task.name not in means)
    waiting = sum(entry.state == "waits" for entry in todo)
    return Estimate(round(sum(seconds.values()), 3), dict(seconds), len(todo), waiting, unknown, open_tasks)


def _means(records: Sequence[Record]) -> dict[str, float]:
    took: defaultdict[str, list[float]] = defaultdict(list)
    for record in records:
        took[record.task].append(record.seconds)
    return {task: fmean(seconds) for task, seconds in took.items()}


def _timing(task: str, records: Sequence[Record]) -> Timing:
    seconds = [record.seconds for record in records]
    return Timing(
        task, len(records), sum(seconds), max(seconds), max(r.peak_bytes for r in records), sum(r.bytes for r in records)
    )
