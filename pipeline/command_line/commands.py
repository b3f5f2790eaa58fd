"""The commands that compute or delete: `run` and `gc`."""

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from kinetree.errors import ConfigError
from kinetree.pipeline.application import current
from kinetree.pipeline.command_line.options import (
    AsJson,
    Executor,
    Follow,
    FollowIdle,
    Force,
    LogJson,
    MadeWithOption,
    Output,
    PerformanceReport,
    Quiet,
    Scheduler,
    SchedulerFile,
    Set,
    StoreAt,
    Target,
    Until,
    WaitWorkers,
    Workers,
    err,
    out,
    pipeline_of,
    print_json,
)
from kinetree.pipeline.command_line.printable import printable
from kinetree.pipeline.storage.sizes import bytes_of

if TYPE_CHECKING:
    from kinetree.pipeline.inspect import Pipeline
    from kinetree.pipeline.inspection.run_summary import RunSummary
    from kinetree.pipeline.running.events import Listener
    from kinetree.pipeline.storage.files import Settling

REMARKS_PRINTED = 12
"""Remarks on the results that are printed after a run."""
FAILURES_PRINTED = 20
"""Failures that are printed after a run; run.json has all."""


def run(
    config: Target = None,
    output: Output = None,
    store: StoreAt = None,
    sets: Set = None,
    until: Until = None,
    force: Force = None,
    made_with: MadeWithOption = None,
    workers: Workers = None,
    executor: Executor = None,
    scheduler: Scheduler = None,
    scheduler_file: SchedulerFile = None,
    wait_workers: WaitWorkers = None,
    performance_report: PerformanceReport = None,
    quiet: Quiet = False,
    log_json: LogJson = None,
    follow: Follow = False,
    follow_idle: FollowIdle = None,
    as_json: AsJson = False,
) -> None:
    """Run the steps that are out of date and say where the results are.

    What is up to date is not computed again. An interrupted run goes on where it stopped.
    """
    from kinetree.pipeline.inspect import Pipeline
    from kinetree.pipeline.settings import config as configuration

    pipeline = pipeline_of(config, output, store, sets)
    files = {"scheduler_file": scheduler_file, "performance_report": performance_report}
    compute = configuration.with_compute(
        pipeline.config,
        workers=workers,
        executor=executor,
        scheduler=scheduler,
        wait_workers=wait_workers,
        **{name: str(file.absolute()) for name, file in files.items() if file is not None},
    )
    chosen = {"until": until, "force": force, "made_with": made_with}
    options: dict[str, Any] = {**chosen, "quiet": quiet, "log_json": log_json, "as_json": as_json}
    if follow or follow_idle is not None:
        _follow(Pipeline.of(compute), follow_idle, options)
    else:
        compute_and_report(Pipeline.of(compute), **options)


def _follow(pipeline: "Pipeline", idle: float | None, options: dict[str, Any]) -> None:
    """Computes again and again as the input grows; raises typer.Exit with code 1 where nodes of the last run failed."""
    from kinetree.pipeline.command_line.follow import follow

    failed = False

    def compute(settling: "Settling") -> None:
        nonlocal failed
        try:
            compute_and_report(pipeline, **options, settling=settling)
            failed = False
        except typer.Exit:
            failed = True

    follow(pipeline, compute, lambda text: err.print(printable(text), markup=False), idle=idle)
    if failed:
        raise typer.Exit(1)


def compute_and_report(
    pipeline: "Pipeline",
    *,
    until: list[str] | None = None,
    force: list[str] | None = None,
    made_with: list[str] | None = None,
    quiet: bool = False,
    log_json: Path | None = None,
    as_json: bool = False,
    settling: "Settling | None" = None,
) -> None:
    """Runs a pipeline with its progress and prints the summary, as `run` does.

    raises : typer.Exit with code 1 where nodes failed; what `Pipeline.run` raises; ConfigError where the log cannot be written
    """
    with _progress(pipeline, quiet or as_json, log_json) as listeners:
        summary = pipeline.run(
            until=until or (), force=force or (), made_with=made_with or (), listeners=listeners, settling=settling
        )
    if as_json:
        print_json(summary)
    elif not quiet:
        _print_summary(summary, pipeline)
    if summary["status"] == "failed":
        if quiet:
            _print_failures(summary)
        raise typer.Exit(1)


def gc(
    config: Target = None,
    keep: Annotated[
        list[str] | None, typer.Option("--keep", metavar="RUN", help="Keep what this run needs; may be repeated.")
    ] = None,
    keep_last: Annotated[
        int | None, typer.Option("--keep-last", min=0, help="Keep what the last N runs of each output folder need.")
    ] = None,
    keep_days: Annotated[
        float | None, typer.Option("--keep-days", min=0, metavar="DAYS", help="Keep what runs of the last days need as well.")
    ] = None,
    max_size: Annotated[
        str | None,
        typer.Option("--max-size", metavar="SIZE", help="Let go of the oldest runs until the store is no larger, e.g. 20GB."),
    ] = None,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Delete nothing; only say what would be deleted.")] = False,
    store: StoreAt = None,
    as_json: AsJson = False,
) -> None:
    """Delete from the store what no longer belongs to a run you keep.

    Without options the last run of each output folder is kept. A run that is under way keeps what it uses, whatever the size.
    """
    from kinetree.pipeline.storage import gc as collection

    pipeline = pipeline_of(config, store=store)
    size = None if max_size is None else _size("--max-size", max_size)
    garbage = collection.collect(pipeline.store, keep=keep or (), last=keep_last, days=keep_days, size=size, dry=dry_run)
    if as_json:
        print_json(garbage.json())
    else:
        verb = "would delete" if dry_run else "deleted"
        out.print(f"{verb} {garbage} in {printable(pipeline.store.url)}", markup=False)


def verify(
    config: Target = None,
    repair: Annotated[bool, typer.Option("--repair", help="Remove what is damaged and compute it again.")] = False,
    store: StoreAt = None,
    as_json: AsJson = False,
) -> None:
    """Read all of a store and say what is damaged; with --repair, compute that again.

    Exit code 1 where something is damaged and was not repaired.
    """
    from kinetree.pipeline.planning import verify as verifying
    from kinetree.pipeline.storage.store import artifact_path

    pipeline = pipeline_of(config, store=store)
    verified = verifying.verify(pipeline.store, current().methods().values())
    if as_json:
        print_json(verified.json())
    else:
        for line in verified.lines():
            out.print(printable(line), markup=False)
        out.print(f"{verified.artifacts} artifacts read; {'nothing is damaged' if verified.is_sound else 'damaged: see above'}")
    if repair and not verified.is_sound:
        verifying.discard_damage(pipeline.store, verified)
        compute_and_report(pipeline, quiet=as_json)
        if missing := verifying.missing(pipeline.store):
            for digest, what in missing.items():
                err.print(f"{artifact_path(digest)}: {what}", markup=False)
            raise typer.Exit(1)
    elif not verified.is_sound:
        raise typer.Exit(1)


def _size(option: str, size: str) -> int:
    try:
        return bytes_of(size)
    except ValueError as error:
        raise ConfigError(f"{option} {size}: {error}") from None


@contextlib.contextmanager
def _progress(pipeline: "Pipeline", quiet: bool, log: Path | None) -> "Iterator[list[Listener]]":
    from kinetree.pipeline.command_line.progress import LiveProgress, PlainProgress
    from kinetree.pipeline.running.events import JsonLog

    with contextlib.ExitStack() as stack:
        listeners: list[Listener] = []
        if log is not None:
            try:
                listeners.append(JsonLog(stack.enter_context(log.open("a", encoding="utf-8", errors="backslashreplace"))))
            except OSError as error:
                raise ConfigError(f"--log-json {log}: cannot be written: {error.strerror}; name another file") from None
        if not quiet:
            workers = pipeline.config.compute.worker_count
            if err.is_terminal:
                listeners.append(stack.enter_context(LiveProgress(err, workers)))
            else:
                listeners.append(stack.enter_context(PlainProgress(err, workers)))
        yield listeners


def _print_summary(summary: "RunSummary", pipeline: "Pipeline") -> None:
    from kinetree.pipeline.command_line.progress import clock

    counts = summary["nodes"]
    line = ", ".join(f"{count} {name}" for name, count in counts.items() if count or name in ("ran", "fresh"))
    _print_failures(summary)
    for note in summary.get("notes", ()):
        err.print(printable(note), markup=False)
    out.print(f"{summary['status']}: {line} in {clock(summary['seconds'])}")
    remarks = summary.there.remarks()
    for node, text in remarks[:REMARKS_PRINTED]:
        out.print(f"{node}: {printable(text)}", markup=False)
    if len(remarks) > REMARKS_PRINTED:
        out.print(f"… and {len(remarks) - REMARKS_PRINTED} more remarks")
    out.print(f"results: {printable(pipeline.config.output)}", markup=False)


def _print_failures(summary: dict[str, Any]) -> None:
    failures = summary["failures"]
    for failure in failures[:FAILURES_PRINTED]:
        line = printable(f"{failure['node']}: {failure['error']}: {failure['message']}")
        err.print(line, markup=False, style="red")
    if len(failures) > FAILURES_PRINTED:
        err.print(f"… and {len(failures) - FAILURES_PRINTED} more, all in run.json", markup=False, style="red")
