"""`kinetree view`: the report of a run, in a browser."""

import os
import sys
import webbrowser
from pathlib import Path
from typing import Annotated

import typer

from kinetree.errors import ConfigError
from kinetree.pipeline.command_line.options import pipeline_of


def view(
    run: Annotated[str, typer.Argument(metavar="RUN", help="A configuration or the output folder of a run.")],
    only_print: Annotated[bool, typer.Option("--print", help="Only print the path.")] = False,
) -> None:
    """Open the report of a run in a browser.

    Where there is no screen, print its path.
    """
    from kinetree.pipeline.views import page_name
    from kinetree.schemas.results.report import Report

    path = pipeline_of(run).config.output / page_name(Report)
    if not path.is_file():
        raise ConfigError(f"{path}: there is no report yet; kinetree run {run} computes it")
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
