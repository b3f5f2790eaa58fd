"""`kinetree view`: the report of a run, in a browser."""

import os
import sys
import webbrowser
from pathlib import Path
from typing import Annotated

import typer

from kinetree.errors import ConfigError
from kinetree.pipeline.inspect import Pipeline
from kinetree.pipeline.views import page_name
from kinetree.schemas.results.report import Report

EXAMPLES = "Examples: kinetree view walk-out · kinetree view walk-out --print"


def register(app: typer.Typer) -> None:
    """Adds the command to the command line."""
    app.command(epilog=EXAMPLES)(view)


def view(
    run: Annotated[str, typer.Argument(metavar="RUN", help="A configuration or the output folder of a run.")],
    only_print: Annotated[bool, typer.Option("--print", help="Print the path and open nothing.")] = False,
) -> None:
    """Open the report of a run in a browser, or print its path where there is none."""
    path = Pipeline.of(run).config.output / page_name(Report)
    if not path.is_file():
        raise ConfigError(f"{path} is not there: the run has not come as far as its report; kinetree run {run}")
    if only_print or not _screen() or not _opened(path):
        typer.echo(str(path))


def _screen() -> bool:
    """Whether there is a screen that a browser could open on; text browsers cannot play the report."""
    return sys.platform in ("darwin", "win32") or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def _opened(path: Path) -> bool:
    try:
        return webbrowser.open(path.absolute().as_uri())
    except webbrowser.Error:
        return False
