"""What a run over a data set would do: each sequence new, changed, fresh, failed last time, and how long it would take."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from statistics import median
from typing import Any, Literal

from kinetree.pipeline.inspection.look import html_table
from kinetree.pipeline.inspection.snapshot import Snapshot
from kinetree.pipeline.output.outcome import Outcome

PlannedState = Literal["new", "changed", "fresh", "failed", "unfinished", "refused"]
COLUMNS = ("name", "state", "nodes", "seconds", "why")


@dataclass(frozen=True)
class PlannedSequence:
    """One sequence of a plan."""

    name: str
    state: PlannedState
    """failed: it failed last time and would be tried again; unfinished: it was interrupted; refused: its input is wrong."""
    nodes: int = 0
    """Nodes known now that would be computed."""
    seconds: float | None = None
    """Seconds of computing expected from earlier runs; None where none tells."""
    why: str = ""

    def cells(self) -> tuple[str, ...]:
        """The sequence's line of a table."""
        seconds = "" if self.seconds is None else f"{self.seconds:.1f}"
        return (self.name, self.state, str(self.nodes or ""), seconds, self.why)


@dataclass(frozen=True)
class DatasetPlan:
    """What a run over a data set would do; making one computes nothing."""

    sequences: tuple[PlannedSequence, ...]
    notes: tuple[str, ...] = ()

    @property
    def counts(self) -> dict[str, int]:
        """Sequences by state."""
        states = [sequence.state for sequence in self.sequences]
        return {state: states.count(state) for state in dict.fromkeys(states)}

    @property
    def seconds(self) -> float:
        """Seconds of computing expected in all, as far as earlier runs tell."""
        return round(sum(sequence.seconds or 0.0 for sequence in self.sequences), 3)

    def __getitem__(self, name: str) -> PlannedSequence:
        """The sequence of that name; raises KeyError."""
        return {sequence.name: sequence for sequence in self.sequences}[name]

    def json(self) -> dict[str, Any]:
        """As JSON values."""
        rows = [asdict(sequence) for sequence in self.sequences]
        return {"counts": self.counts, "seconds": self.seconds, "notes": list(self.notes), "sequences": rows}

    def __repr__(self) -> str:
        return "\n".join("  ".join(filter(None, sequence.cells())) for sequence in self.sequences)

    def _repr_html_(self) -> str:
        return html_table(COLUMNS, [sequence.cells() for sequence in self.sequences])


def planned(name: str, there: Snapshot, before: Outcome | None, rate: float | None) -> PlannedSequence:
    """The plan of one sequence.

    before : as its last run left it; None where there was none
    rate   : seconds of computing for each member of the input, from other sequences; None where nothing is known
    """
    plan = there.plan
    if plan.is_done:
        return PlannedSequence(name, "fresh")
    nodes = sum(node.state != "fresh" for node in plan.nodes)
    expected = there.estimate()
    members = sum(len(artifacts) for artifacts in there.schedule.origin_artifacts.values())
    by_rate = None if rate is None else round(rate * members, 1)
    if before is None:
        return PlannedSequence(name, "new", nodes, by_rate)
    seconds = by_rate if expected.unknown else round(expected.seconds, 1)
    if before.status == "failed":
        why = before.failures[0] if before.failures else {}
        return PlannedSequence(name, "failed", nodes, seconds, f"{why.get('node', '')} {why.get('message', '')}".strip())
    if not before.is_done:
        return PlannedSequence(name, "unfinished", nodes, seconds, f"{before.status} {before.ended}")
    return PlannedSequence(name, "changed", nodes, seconds, _why(there))


def rate(outcomes: Sequence[Outcome]) -> float | None:
    """Seconds of computing for each member of the input: the median of the sequences that were computed."""
    known = [o.seconds / o.members for o in outcomes if o.is_done and o.members]
    return median(known) if known else None


def _why(there: Snapshot) -> str:
    """The reasons of the first task that is out of date."""
    for task in there.plan.tasks:
        reasons = [reason for reason in task.reasons if not reason.startswith("waits")]
        if reasons:
            more = f" and {len(reasons) - 1} more reasons" if len(reasons) > 1 else ""
            return f"{task.task}: {reasons[0]}{more}"
    return ""
