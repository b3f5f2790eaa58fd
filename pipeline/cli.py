"""The command `kinetree`: what it takes and what it prints; everything it does is `Pipeline`'s."""

import contextlib
import errno
import io
import os
import signal
import sys
import threading
import traceback
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path
from typing import Annotated, Any, NoReturn

import typer

from kinetree.errors import ConfigError, InputError, KinetreeError
from kinetree.pipeline import asking
from kinetree.pipeline import config as configuration
from kinetree.pipeline import gc as collection
from kinetree.pipeline.events import JsonLog, Listener
from kinetree.pipeline.inspect import Pipeline
from kinetree.pipeline.options import (
    AsJson,
    Force,
    Frames,
    Input,
    Output,
    Set,
    StoreAt,
    Target,
    Until,
    err,
    out,
    pipeline_of,
    print_json,
)
from kinetree.pipeline.plan import Plan
from kinetree.pipeline.printable import printable
from kinetree.pipeline.progress import LiveProgress, PlainProgress, clock

EXITS = "Exit codes: 0 done · 1 nodes failed · 2 the input is wrong · 130 interrupted"
app = typer.Typer(
    name="kinetree",
    help="Kinematic structure of a moving body from 3D video: a tree of joints and bones from meshes whose vertices and"
    " connectivity change in every frame.",
    epilog=EXITS,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
)

ENVIRONMENT = (
    errno.EACCES, errno.EPERM, errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.ENAMETOOLONG, errno.EIO, errno.EMFILE,
    errno.ENFILE, errno.ELOOP, errno.ENOTDIR, errno.ESTALE, errno.ENOMEM,
)  # fmt: skip
"""What a system refuses for reasons that lie in it and not in kinetree."""
REMARKS = 12
"""Remarks printed after a run."""


@app.command(epilog=f"Examples: kinetree run --input scans/ --output walk/ · kinetree run walk.yaml --until mesh\n\n{EXITS}")
def run(
    config: Target = None,
    source: Input = None,
    output: Output = None,
    store: StoreAt = None,
    frames: Frames = None,
    sets: Set = None,
    until: Until = None,
    force: Force = None,
    workers: Annotated[int | None, typer.Option("--workers", help="How many at the same time; default: one per core.")] = None,
    executor: Annotated[str | None, typer.Option("--executor", help="sync, threads or processes.")] = None,
    scheduler: Annotated[str | None, typer.Option("--scheduler", metavar="ADDRESS", help="A running dask scheduler.")] = None,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print nothing but errors.")] = False,
    log_json: Annotated[Path | None, typer.Option("--log-json", metavar="FILE", help="One event a line.")] = None,
    as_json: AsJson = False,
) -> None:
    """Compute what is not fresh and say where the results are."""
    pipeline = pipeline_of(config, source, output, store, frames, sets)
    compute = configuration.with_compute(pipeline.config, workers=workers, executor=executor, scheduler=scheduler)
    pipeline = Pipeline.of(compute)
    with _progress(pipeline, quiet or as_json, log_json) as listeners:
        told = pipeline.run(until=until or (), force=force or (), listeners=listeners)
    if as_json:
        print_json(told)
    elif not quiet:
        _print_summary(told, pipeline)
    if told["status"] == "failed":
        if quiet:
            _print_failures(told)
        raise typer.Exit(1)


@app.command(epilog="Examples: kinetree plan walk.yaml · kinetree plan walk/ --set mesh.component_share=0.1 --json")
def plan(
    config: Target = None,
    source: Input = None,
    output: Output = None,
    store: StoreAt = None,
    frames: Frames = None,
    sets: Set = None,
    until: Until = None,
    force: Force = None,
    nodes: Annotated[bool, typer.Option("--nodes", help="One line a node instead of one a task.")] = False,
    as_json: AsJson = False,
) -> None:
    """Say what a run would compute and why; computes nothing."""
    found = pipeline_of(config, source, output, store, frames, sets).plan(until=until or (), force=force or ())
    if as_json:
        print_json(found.json())
    else:
        _print_plan(found, nodes)


@app.command(epilog="Examples: kinetree gc walk/ --dry-run · kinetree gc walk/ --keep-last 3")
def gc(
    config: Target = None,
    keep: Annotated[list[str] | None, typer.Option("--keep", metavar="RUN", help="Keep what this run used.")] = None,
    keep_last: Annotated[int | None, typer.Option("--keep-last", min=0, help="Keep the last N runs of each output.")] = None,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Only say what would be freed.")] = False,
    store: StoreAt = None,
    as_json: AsJson = False,
) -> None:
    """Free what none of the kept runs needs; without options the last run of each output folder is kept."""
    pipeline = pipeline_of(config, store=store)
    garbage = collection.collect(pipeline.store, keep=keep or (), last=keep_last, dry=dry_run)
    if as_json:
        print_json(garbage.json())
    else:
        out.print(f"{'would free' if dry_run else 'freed'} {garbage} in {printable(pipeline.store.url)}", markup=False)


@app.callback(invoke_without_command=True)
def _root(show_version: Annotated[bool, typer.Option("--version", help="Print the version.")] = False) -> None:
    if show_version:
        typer.echo(version("kinetree"))
        raise typer.Exit


def command_line() -> typer.Typer:
    """The whole command line: the loom's commands and those of the tasks."""
    from kinetree.tasks.commands import register

    if not any(command.callback is not None and command.callback.__name__ == "synth" for command in app.registered_commands):
        asking.register(app)
        register(app)
    return app


def main() -> NoReturn:
    """The console script: every refusal is one message and an exit code, never a traceback."""
    signal.signal(signal.SIGTERM, _interrupt)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a terminal that cannot show × must not end a run
    try:
        code = int(command_line()(standalone_mode=False) or 0)  # the command returns the code of a typer.Exit
    except InputError as error:
        _print_error(error)
        code = 2
    except KinetreeError as error:
        _print_error(error)
        code = 1
    except (KeyboardInterrupt, typer.Abort):
        code = 130
    except BrokenPipeError:
        sys.stderr.close()
        code = 141
    except Exception as error:
        code = _unexpected(error)
    if code == 130:
        err.print("kinetree: interrupted; what is finished is kept, run again to go on", markup=False)
        if threading.active_count() > 1:
            _leave(code)
    raise SystemExit(code)


def _leave(code: int) -> NoReturn:
    """Ends the process though threads are in the middle of nodes, which may take minutes; the store is whole anyway."""
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError, ValueError):
            stream.flush()
    os._exit(code)


def _unexpected(error: Exception) -> int:
    """Click's own refusals of options and arguments, and errors that are ours."""
    told = getattr(error, "format_message", None)
    if told is not None:
        if told():  # the help that a bare command asks for is printed already
            err.print(f"kinetree: {printable(told())}\nTry kinetree --help", markup=False, style="red")
        return 2
    if isinstance(error, OSError) and error.errno in ENVIRONMENT:
        err.print(f"kinetree: {printable(error.filename or 'the system')}: {error.strerror}", markup=False, style="red")
        return 2
    traceback.print_exception(error)
    err.print("kinetree: this is an error in kinetree itself; the store is whole. Please report it with the lines above.")
    return 1


def _print_error(error: KinetreeError) -> None:
    lines = isinstance(error, ConfigError)  # one line a key; elsewhere a line end is part of somebody's file name
    err.print(f"kinetree: {printable(error, lines=lines)}", markup=False, style="red")


def _interrupt(*_: object) -> NoReturn:
    raise KeyboardInterrupt


@contextlib.contextmanager
def _progress(pipeline: Pipeline, quiet: bool, log: Path | None) -> Iterator[list[Listener]]:
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


def _print_plan(found: Plan, nodes: bool) -> None:
    for row in found.nodes if nodes else found.tasks:
        out.print(printable(row), markup=False)
    if found.is_done:
        out.print("everything is fresh; a run would compute nothing")


def _print_summary(told: dict[str, Any], pipeline: Pipeline) -> None:
    counts = told["nodes"]
    line = ", ".join(f"{count} {name}" for name, count in counts.items() if count or name in ("ran", "fresh"))
    _print_failures(told)
    out.print(f"{told['status']}: {line} in {clock(told['seconds'])}")
    remarks = pipeline.remarks()
    for node, text in remarks[:REMARKS]:
        out.print(f"{node}: {printable(text)}", markup=False)
    if len(remarks) > REMARKS:
        out.print(f"… and {len(remarks) - REMARKS} more remarks")
    out.print(f"results: {printable(pipeline.config.output)}", markup=False)


def _print_failures(told: dict[str, Any]) -> None:
    for failure in told["failures"][:20]:
        line = printable(f"{failure['node']}: {failure['error']}: {failure['message']}")
        err.print(line, markup=False, style="red")
    if len(told["failures"]) > 20:
        err.print(f"… and {len(told['failures']) - 20} more, all in run.json", markup=False, style="red")
