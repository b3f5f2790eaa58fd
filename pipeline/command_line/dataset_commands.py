"""The command on data sets: run, plan, status and report over many sequences."""

from dataclasses import dataclass, field
from enum import StrEnum, auto
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from kinetree.errors import ConfigError, KinetreeError
from kinetree.pipeline.application import current
from kinetree.pipeline.command_line.options import AsJson, Executor, Quiet, Scheduler, Set, Workers, err, out, print_json
from kinetree.pipeline.command_line.printable import printable

if TYPE_CHECKING:
    from kinetree.pipeline.dataset.dataset import Dataset

WHY_PRINTED = 3
"""Failures of a sequence that are printed; its outcome.json has all."""


class Action(StrEnum):
    """What is to be done with a data set."""

    RUN = auto()
    PLAN = auto()
    STATUS = auto()
    REPORT = auto()


def dataset(
    action: Annotated[
        Action,
        typer.Argument(
            help="run: compute what is out of date; plan: say what that would be; status: say what became of each sequence last"
            " time; report: bring the summary up to date and compute nothing else."
        ),
    ],
    file: Annotated[Path, typer.Argument(help="The data set's YAML file.", show_default=False)],
    only: Annotated[
        list[str] | None, typer.Option("--only", metavar="PATTERN", help="Only sequences of such names; may be repeated.")
    ] = None,
    failed: Annotated[bool, typer.Option("--failed", help="Only sequences that failed last time.")] = False,
    since: Annotated[
        str | None,
        typer.Option("--since", metavar="DATE", help="Only sequences whose input changed since a date, or within 36h or 7d."),
    ] = None,
    max_hours: Annotated[
        float | None, typer.Option("--max-hours", min=0, help="Send nothing more after this time; the next run goes on.")
    ] = None,
    sets: Set = None,
    workers: Workers = None,
    executor: Executor = None,
    scheduler: Scheduler = None,
    quiet: Quiet = False,
    as_json: AsJson = False,
) -> None:
    """Run, plan or look at many sequences with one configuration.

    Where nothing is new, run prints nothing but to a terminal. It may be started at any time, also twice at once.
    """
    from kinetree.pipeline.dataset.dataset import Dataset
    from kinetree.pipeline.settings.config import with_changes

    selects = {"--only": only, "--failed": failed, "--since": since}
    for option, value in {**selects, "--max-hours": max_hours}.items():
        is_taken = action is Action.RUN or (action is Action.PLAN and option in selects)
        if value and not is_taken:
            raise ConfigError(f"dataset {action.value} takes no {option}; dataset run does")
    data_set = Dataset.of(file, sets=sets or (), application=current())
    data_set = data_set.computed_by(
        with_changes(data_set.config.compute, workers=workers, executor=executor, scheduler=scheduler)
    )
    chosen: dict[str, Any] = {"only": tuple(only or ()), "failed": failed, "since": since}
    if action is Action.PLAN:
        _plan(data_set, chosen, as_json=as_json)
    elif action is Action.STATUS:
        _status(data_set, as_json=as_json)
    elif action is Action.REPORT:
        _report(data_set, as_json=as_json)
    else:
        _run(data_set, {**chosen, "max_hours": max_hours}, quiet=quiet, as_json=as_json)


def _run(data_set: "Dataset", chosen: dict[str, Any], *, quiet: bool, as_json: bool) -> None:
    listeners = [] if quiet or as_json else [Progress(err, len(data_set))]
    try:
        record = data_set.run(**chosen, listeners=listeners)
    except (KinetreeError, KeyboardInterrupt):
        if as_json and (last := data_set.last_record()) is not None:
            print_json(last)
        raise
    counts = record["counts"]
    if as_json:
        print_json(record)
    elif not quiet and (out.is_terminal or counts["fresh"] != sum(counts.values())):
        line = ", ".join(f"{count} {state}" for state, count in counts.items() if count)
        out.print(f"{record['status']}: {line or 'no sequence chosen'} in {record['seconds']:.1f} s")
        files = record.get("summary", {}).get("files", ())
        out.print(
            f"results: {printable(data_set.config.root)}{f' ({printable(chr(44).join(files))})' if files else ''}", markup=False
        )
    if not as_json and not quiet:
        for note in record["notes"] if out.is_terminal else ():
            err.print(printable(note), markup=False)
    if "metrics_error" in record and not as_json:
        err.print(printable(record["metrics_error"]), markup=False)
    if record["status"] == "failed":
        if not as_json:
            _print_failures(record)
        raise typer.Exit(1)


def _print_failures(record: dict[str, Any]) -> None:
    for name, row in record["sequences"].items():
        failures = row.get("failures", ()) if row["state"] == "failed" else ()
        for failure in failures[:WHY_PRINTED]:
            node = f"{failure['node']}: " if failure["node"] else ""
            err.print(printable(f"{name}: {node}{failure['error']}: {failure['message']}"), markup=False, style="red")
        if len(failures) > WHY_PRINTED:
            err.print(printable(f"{name}: … and {len(failures) - WHY_PRINTED} more"), markup=False, style="red")
    for failure in record.get("summary", {}).get("failures", ()):
        err.print(printable(f"summary: {failure['node']}: {failure['message']}"), markup=False, style="red")
    if "on_failure" in record:
        err.print(printable(record["on_failure"]), markup=False)


def _plan(data_set: "Dataset", chosen: dict[str, Any], *, as_json: bool) -> None:
    from kinetree.pipeline.dataset.dataset_plan import COLUMNS

    plan = data_set.plan(**chosen)
    if as_json:
        print_json(plan.json())
        return
    _print_table(COLUMNS, [row.cells() for row in plan.sequences])
    for note in plan.notes:
        out.print(printable(note), markup=False)
    line = ", ".join(f"{count} {state}" for state, count in plan.counts.items())
    out.print(f"{line}; about {plan.seconds:.0f} s of computing" if plan.seconds else line)


def _status(data_set: "Dataset", *, as_json: bool) -> None:
    rows = data_set.status()
    if as_json:
        print_json(rows)
        return
    _print_table(tuple(rows[0]), [tuple("" if v is None else str(v) for v in row.values()) for row in rows])


def _report(data_set: "Dataset", *, as_json: bool) -> None:
    outcome = data_set.report()
    if as_json:
        print_json(outcome)
    else:
        for path in outcome["files"]:
            out.print(printable(path), markup=False)
    if outcome["status"] != "done":
        for failure in outcome["failures"]:
            err.print(printable(f"{failure['node']}: {failure['message']}"), markup=False, style="red")
        raise typer.Exit(1)


def _print_table(head: tuple[str, ...], rows: list[tuple[str, ...]]) -> None:
    table = Table(box=None, pad_edge=False, header_style="bold")
    for name in head:
        table.add_column(name, overflow="fold")
    for row in rows:
        table.add_row(*(escape(printable(cell)) for cell in row))
    out.print(table)


@dataclass
class Progress:
    """A line for every sequence that was computed or refused."""

    console: Console
    count: int
    _ran: dict[str, int] = field(default_factory=dict)

    def hear(self, event: dict[str, Any]) -> None:
        """Counts an event and prints what is worth a line."""
        name = event["name"]
        if event["event"] == "finish":
            self._ran[name] = self._ran.get(name, 0) + 1
        elif event["event"] == "end" and (event["status"] != "done" or name in self._ran):
            self._say(f"{name}: {event['status']}, {self._ran.get(name, 0)} nodes computed in {event['seconds']:.1f} s")
        elif event["event"] == "refused":
            self._say(f"{name}: refused: {event['message']}")

    def _say(self, line: str) -> None:
        self.console.print(printable(line), markup=False, highlight=False, soft_wrap=True)
