"""What commands share: their arguments and options, the pipeline they name, and the two consoles."""

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console

from kinetree.errors import ConfigError
from kinetree.pipeline.application import Application, current
from kinetree.pipeline.command_line.printable import printable
from kinetree.pipeline.settings.option import OptionSetting

if TYPE_CHECKING:
    from kinetree.pipeline.inspect import Pipeline

Target = Annotated[
    str | None,
    typer.Argument(
        metavar="[CONFIG]",
        help="A YAML file, the name of a preset, or the output folder of an earlier run. Default: the current folder if it is"
        " such a folder.",
        show_default=False,
    ),
]
Set = Annotated[list[str] | None, typer.Option("--set", metavar="TASK.NAME=VALUE", help="Set one parameter; may be repeated.")]
Output = Annotated[str | None, typer.Option("--output", "-o", help="Folder for the results.")]
StoreAt = Annotated[
    str | None, typer.Option("--store", help="Folder or s3:// address in which computed data is kept; default: OUTPUT/store.")
]
Until = Annotated[
    list[str] | None,
    typer.Option("--until", metavar="TASK", help="Only this task and those it needs; may be repeated."),
]
Force = Annotated[
    list[str] | None, typer.Option("--force", metavar="TASK", help="Run this task even if it is up to date; may be repeated.")
]
MadeWithOption = Annotated[
    list[str] | None,
    typer.Option(
        "--made-with",
        metavar="LIBRARY<VERSION",
        help="Count results computed with this library version as out of date, e.g. 'scipy<1.17'; may be repeated.",
    ),
]
Workers = Annotated[
    int | None, typer.Option("--workers", help="How many nodes to compute at the same time; default: one per core.")
]
Executor = Annotated[str | None, typer.Option("--executor", help="sync, threads or processes.")]
Scheduler = Annotated[
    str | None,
    typer.Option("--scheduler", metavar="ADDRESS", help="Compute on a dask scheduler that runs at this address."),
]
SchedulerFile = Annotated[
    Path | None,
    typer.Option("--scheduler-file", metavar="FILE", help="The same, for a scheduler that wrote its address to this file."),
]
WaitWorkers = Annotated[
    str | None,
    typer.Option(
        "--wait-workers",
        metavar="N[,SECONDS]",
        help="Begin when N workers are there; give up after SECONDS without them, or without any (300).",
    ),
]
PerformanceReport = Annotated[
    Path | None,
    typer.Option("--performance-report", metavar="FILE", help="Write dask's report on the run, a page of HTML."),
]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Print only errors.")]
LogJson = Annotated[
    Path | None,
    typer.Option("--log-json", metavar="FILE", help="Append every event of the run to this file, one JSON a line."),
]
Follow = Annotated[
    bool, typer.Option("--follow", help="Go on as the input grows: compute each file as soon as it is complete.")
]
FollowIdle = Annotated[
    float | None,
    typer.Option("--follow-idle", min=0, metavar="SECONDS", help="Follow, until nothing new came for so long; means --follow."),
]
AsJson = Annotated[bool, typer.Option("--json", help="Print JSON.")]
out = Console(soft_wrap=True, highlight=False, width=None if sys.stdout.isatty() else 200)  # a pipe cuts no table short
err = Console(stderr=True, soft_wrap=True, highlight=False)


def tell(remark: str) -> None:
    """Prints a remark where it does not mix with results, which may be JSON."""
    err.print(printable(remark), markup=False)


def pipeline_of(
    config: str | None, output: str | None = None, store: str | None = None, sets: list[str] | None = None
) -> "Pipeline":
    """The pipeline that arguments and options name; options win over the file.

    raises : ConfigError where nothing is named and the current folder is not the output of a run
    """
    from kinetree.pipeline.inspect import Pipeline

    application = current()
    folders = {"output": output, "store": store}
    named = (OptionSetting.of(f"--{key}", key, value) for key, value in folders.items() if value is not None)
    changes = [*(sets or ()), *named]
    has_input = _has_input(application, changes)
    target = config if config is not None or has_input else here()
    if target is None and not has_input and store is None:
        raise ConfigError(f"nothing to work on: name a configuration or an output folder{_instead(application)}")
    return Pipeline.of(target, sets=changes, application=application)


def _has_input(application: Application, sets: list[str]) -> bool:
    inputs = {shortcut.parameter for shortcut in application.shortcuts if shortcut.is_input}
    return any(text.partition("=")[0].strip() in inputs for text in sets)


def _instead(application: Application) -> str:
    """Which options stand for a configuration, and with which commands."""
    options = [f"{s.options[0]} {s.metavar}" for s in application.shortcuts if s.is_input]
    names = [command.name for command in application.commands.values() if command.takes_shortcuts]
    return f" ({' and '.join(names)} also take {' or '.join(options)})" if options else ""


def here() -> str | None:
    """The current folder or the default output folder in it, whichever is the output of a run; None where neither is."""
    from kinetree.pipeline.settings.blocks import SAVED

    folders = (Path(), Path(f"{current().name}-output"))
    return next((str(folder) for folder in folders if (folder / SAVED).is_file()), None)


def print_json(value: Any) -> None:
    """Prints a value as JSON; what JSON does not know as text."""
    typer.echo(json.dumps(value, indent=2, ensure_ascii=False, default=str))


def brief(value: Any) -> str:
    """A value on one line, long lists cut after six."""
    if isinstance(value, list | tuple):
        more = f" and {len(value) - 6} more" if len(value) > 6 else ""
        return ", ".join(map(str, value[:6])) + more
    if isinstance(value, dict):
        return ", ".join(f"{k} {brief(v)}" for k, v in value.items())
    return str(value)
