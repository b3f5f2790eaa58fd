"""The graph that sums up a data set of toy sequences; what it begins with is the toy graph's report of each."""

import json
from collections.abc import Mapping
from typing import Any, ClassVar

from kinetree.pipeline.graph import Graph
from kinetree.pipeline.task import linked, origin, task
from kinetree.pipeline.views import files_of, rows_of
from kinetree.schemas.array import Artifact, Index, Params

from .toys import Report, executed, report


class SequenceOutcome(Params):
    """What became of one sequence."""

    name: str
    output: str
    method: str
    status: str
    seconds: float
    remarks: tuple[str, ...]
    failures: tuple[str, ...]
    files: tuple[str, ...]
    has_result: bool


class OutcomesParams(Params):
    """What became of all."""

    sequences: tuple[SequenceOutcome, ...] = ()
    """In order."""


class Outcomes(Artifact):
    """What became of all."""

    opens: ClassVar[tuple[str, ...]] = ("sequence",)
    sequences: tuple[SequenceOutcome, ...]
    """In order."""

    def members(self, space: str, index: Index) -> tuple[int, ...]:
        """Those that have a result."""
        return tuple(n for n, sequence in enumerate(self.sequences) if sequence.has_result)


class Figure(Artifact):
    """One sequence in the summary."""

    value: float
    """Its report's."""


class Summary(Artifact):
    """All sequences."""

    values: dict[str, float | None]
    """By name."""


@origin()
def outcomes(params: OutcomesParams, files: object) -> Outcomes:
    """Takes over what became of them."""
    return Outcomes(sequences=params.sequences)


@task(over="sequence")
def figure(report: Report) -> Figure:
    """Reads one report."""
    executed("figure", report.value)
    return Figure(value=report.value)


@task()
def summed(outcomes: Outcomes, figure: Mapping[int, Figure]) -> Summary:
    """Gathers all."""
    executed("summed", len(figure))
    values = {s.name: figure[n].value if n in figure else None for n, s in enumerate(outcomes.sequences)}
    return Summary(values=values)


@files_of(Summary)
def summary_files(summary: Summary, index: Index) -> Mapping[str, bytes]:
    """The values."""
    return {"summary.json": json.dumps(summary.values).encode()}


@rows_of(Summary)
def summary_rows(summary: Summary) -> list[dict[str, Any]]:
    """One row a sequence."""
    return [{"name": name, "value": value} for name, value in summary.values.items()]


GRAPH = Graph.of((linked(report, over="sequence"), outcomes, figure, summed))
