"""A plan: every node with its state and the reason for it, as text, as a table in a notebook, as JSON."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

from kinetree.pipeline.inspection.look import html_table
from kinetree.pipeline.planning.entry import DONE, Entry
from kinetree.pipeline.planning.reason import Reason
from kinetree.pipeline.planning.schedule import Schedule

PlanState = Literal["fresh", "stale", "waits"]


@dataclass(frozen=True)
class Planned:
    """One node of a plan."""

    node: str
    task: str
    state: PlanState
    reasons: tuple[Reason, ...]
    """Why it is stale."""
    waits: tuple[str, ...]
    """The nodes it waits for."""
    key: str | None
    artifact: str | None

    def __str__(self) -> str:
        why = "; ".join(map(str, self.reasons)) or (f"for {_some(self.waits)}" if self.waits else "")
        return f"{self.node}: {self.state}{f' ({why})' if why else ''}"


@dataclass(frozen=True)
class TaskPlan:
    """One task of a plan: how many of its nodes are in which state, and why the first stale ones are."""

    task: str
    over: str
    states: dict[str, int]
    reasons: dict[str, int]
    unknown: tuple[str, ...]
    """Nodes that must be computed before the rest of this task's nodes is known."""

    def __str__(self) -> str:
        total = sum(self.states.values())
        head = f"{self.task} ×{total}" if self.over else self.task
        parts = [f"{count} {state}" if self.over else state for state, count in self.states.items()]
        parts += [f"more once {_some(self.unknown)} is computed"] if self.unknown else []
        why = "; ".join(f"{reason} ×{n}" if n > 1 else reason for reason, n in list(self.reasons.items())[:3])
        return f"{head}: {', '.join(parts)}{f' — {why}' if why else ''}"


@dataclass(frozen=True)
class Plan:
    """What a run would do; making one computes nothing."""

    nodes: tuple[Planned, ...]
    tasks: tuple[TaskPlan, ...]

    @staticmethod
    def of(schedule: Schedule) -> "Plan":
        """The plan that a schedule is before anything ran."""
        nodes = tuple(_planned(schedule, entry) for entry in schedule.entries.values())
        return Plan(nodes, tuple(_tasks(schedule, nodes)))

    @property
    def counts(self) -> dict[str, int]:
        """Nodes by state."""
        return _counted(self.nodes)

    @cached_property
    def by_label(self) -> dict[str, Planned]:
        """Nodes by label."""
        return {n.node: n for n in self.nodes}

    @property
    def is_done(self) -> bool:
        """Whether a run would compute nothing."""
        return all(n.state == "fresh" for n in self.nodes) and not any(t.unknown for t in self.tasks)

    def __getitem__(self, label: str) -> Planned:
        """The node of that label; raises KeyError."""
        return self.by_label[label]

    def json(self) -> dict[str, Any]:
        """The plan as JSON values."""
        return {
            "counts": self.counts,
            "tasks": [
                {"task": t.task, "over": t.over, "states": t.states, "reasons": t.reasons, "unknown": list(t.unknown)}
                for t in self.tasks
            ],
            "nodes": [
                {
                    "node": n.node,
                    "task": n.task,
                    "state": n.state,
                    "reasons": [{"kind": r.kind, "what": r.what} for r in n.reasons],
                    "waits": list(n.waits),
                    "key": n.key,
                    "artifact": n.artifact,
                }
                for n in self.nodes
            ],
        }

    def __repr__(self) -> str:
        """One line a task."""
        return "\n".join(map(str, self.tasks))

    def _repr_html_(self) -> str:
        states = ("fresh", "stale", "waits")
        rows = [(t.task, t.over, *(str(t.states.get(s, 0)) for s in states), "; ".join(t.reasons)) for t in self.tasks]
        return html_table(("task", "over", *states, "why"), rows)


def _planned(schedule: Schedule, entry: Entry) -> Planned:
    waits = tuple(schedule.entries[n].label if n in schedule.entries else n.task for n in sorted(entry.waits))
    is_done = entry.state in DONE
    state: PlanState = "waits" if waits else ("fresh" if is_done else "stale")
    return Planned(entry.label, entry.node.task, state, () if is_done else entry.reasons, waits, entry.key, entry.artifact)


def _tasks(schedule: Schedule, nodes: tuple[Planned, ...]) -> Iterator[TaskPlan]:
    for task in schedule.graph.tasks:
        mine = tuple(n for n in nodes if n.task == task.name)
        reasons = Counter(str(r) for n in mine for r in n.reasons)
        waits = Counter(f"waits for {_some(_tasks_of(n.waits) if task.over else n.waits)}" for n in mine if n.waits)
        unknown = tuple(schedule.entries[n].label for n in schedule.blocked.get(task.name, ()) if n in schedule.entries)
        yield TaskPlan(task.name, "/".join(task.over), _counted(mine), dict((reasons + waits).most_common()), unknown)


def _tasks_of(labels: tuple[str, ...]) -> tuple[str, ...]:
    """The tasks of nodes: that all nodes of one task wait for those of another is one thing to say."""
    return tuple(dict.fromkeys(label.partition("[")[0] for label in labels))


def _counted(nodes: tuple[Planned, ...]) -> dict[str, int]:
    counts = Counter(n.state for n in nodes)
    return {state: counts[state] for state in ("fresh", "stale", "waits") if counts[state]}


def _some(names: tuple[str, ...]) -> str:
    return ", ".join(names[:3]) + (f" and {len(names) - 3} more" if len(names) > 3 else "")
