"""What every command shares: its arguments and options, the pipeline they name, and the two consoles."""

import json
import sys
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console

from kinetree.errors import ConfigError
from kinetree.pipeline.blocks import SAVED
from kinetree.pipeline.inspect import Pipeline

Target = Annotated[
    str | None,
    typer.Argument(
        metavar="[CONFIG]",
        help="A YAML file, a preset's name, or the output folder of an earlier run. Left out: this folder, if it is one.",
        show_default=False,
    ),
]
Set = Annotated[
    list[str] | None, typer.Option("--set", metavar="TASK.NAME=VALUE", help="Override one parameter; may be repeated.")
]
Input = Annotated[
    str | None, typer.Option("--input", "-i", help="Folder or glob of meshes, one a frame; or one .npz or zarr file.")
]
Output = Annotated[str | None, typer.Option("--output", "-o", help="Folder for the results.")]
StoreAt = Annotated[str | None, typer.Option("--store", help="Folder for what is computed; default: OUTPUT/store.")]
Frames = Annotated[str | None, typer.Option("--frames", metavar="START:STOP:STEP", help="Frames wanted, e.g. 10:60:2.")]
Until = Annotated[list[str] | None, typer.Option("--until", metavar="TASK", help="Stop after this task; may be repeated.")]
Force = Annotated[list[str] | None, typer.Option("--force", metavar="TASK", help="Run this task though it is fresh.")]
AsJson = Annotated[bool, typer.Option("--json", help="Print JSON.")]
out = Console(soft_wrap=True, highlight=False, width=None if sys.stdout.isatty() else 200)  # a pipe cuts no table short
err = Console(stderr=True, soft_wrap=True, highlight=False)


def pipeline_of(
    config: str | None,
    source: str | None = None,
    output: str | None = None,
    store: str | None = None,
    frames: str | None = None,
    sets: list[str] | None = None,
) -> Pipeline:
    """The pipeline that arguments and options name; options win over --set, and both over the file."""
    options = {"source.input": source, "source.frames": frames, "output": output, "store": store}
    told = [f"{key}={_quoted(str(value))}" for key, value in options.items() if value is not None]
    target = config if config is not None else (None if source else here())
    if target is None and not source and store is None:
        raise ConfigError("nothing to work on: name a config or an output folder (run and plan also take --input FOLDER)")
    return Pipeline.of(target, sets=[*(sets or ()), *told])


def _quoted(text: str) -> str:
    """The text as a YAML string, whatever characters a path has."""
    return '"' + "".join(c if c.isascii() and c.isalnum() else f"\\U{ord(c):08x}" for c in text) + '"'


def here() -> str | None:
    """The current folder or ./kinetree-output, where it is the output of a run."""
    folders = (Path(), Path("kinetree-output"))
    return next((str(folder) for folder in folders if (folder / SAVED).is_file()), None)


def print_json(value: Any) -> None:
    typer.echo(json.dumps(value, indent=2, ensure_ascii=False, default=str))


def brief(value: Any) -> str:
    if isinstance(value, list | tuple):
        more = f" and {len(value) - 6} more" if len(value) > 6 else ""
        return ", ".join(map(str, value[:6])) + more
    if isinstance(value, dict):
        return ", ".join(f"{k} {brief(v)}" for k, v in value.items())
    return str(value)
