"""`kinetree export`: the result of a run as a file that other programs open."""

import json
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from kinetree.errors import ConfigError
from kinetree.pipeline.command_line.options import AsJson, Set, Target, pipeline_of, print_json
from kinetree.pipeline.command_line.printable import printable
from kinetree.pipeline.suggest import nearest

if TYPE_CHECKING:
    from kinetree.pipeline.inspect import Pipeline

FORMATS = {
    "glb": "glb",
    "blender": "blender",
    "bvh": "bvh",
    "json": "skeleton_json",
    "trc": "trc",
    "c3d": "c3d",
    "csv": "tables",
    "ply": "ply",
    "rignet": "rignet",
    "usd": "usd",
    "zarr": "segmentation",
}
"""The task that writes each format."""
LAID_OUT_BY = ("complete_skeleton", "joint_names", "assumed_joints", "appearance", "glb")
"""Tasks that say how a body looks in files and take no time: they are computed with a file where an option changes them."""
EXTRAS = {"usd": "pxr", "c3d": "ezc3d"}
"""The module without which a format cannot be written; the extra that brings it has the format's name."""
SCHEMA = "json-schema"
MESH_FILES = (".ply", ".obj", ".off", ".stl", ".glb", ".gltf")
"""Endings of meshes: one more of these in the folder of the input would be read as a frame or refused."""


def export(
    run: Target = None,
    to: Annotated[str, typer.Option("--to", metavar="FORMAT", help=f"{', '.join(FORMATS)} or {SCHEMA}.")] = "glb",
    output: Annotated[
        Path | None, typer.Option("--output", "-o", metavar="PATH", help="File or folder; default: the run's own folder.")
    ] = None,
    sets: Set = None,
    as_json: AsJson = False,
) -> None:
    """Write the result of a run as a file for other programs.

    Nothing but the file is computed, and what names and completes the joints in it.

    glb and usd hold the skinned, moving body, blender the same with a script that makes FBX of it, bvh the motion, json the
    joints, trc and c3d the joints as markers, csv tables of motion, angles, lengths and steps, ply your own meshes coloured
    by part, rignet the rig as text, zarr part labels and aligned meshes.
    """
    if to not in (*FORMATS, SCHEMA):
        raise ConfigError(f"--to {to}: no such format; {nearest(to, (*FORMATS, SCHEMA))}")
    if to == SCHEMA:
        _write_schema(output)
        return
    if to in EXTRAS and find_spec(EXTRAS[to]) is None:
        raise ConfigError(f"--to {to} needs a package that is not installed: pip install 'kinetree[{to}]' brings it")
    pipeline = pipeline_of(run, sets=sets)
    written, remarks = _written(pipeline, FORMATS[to], output)
    if as_json:
        print_json({"files": [str(path) for path in written], "remarks": remarks})
        return
    for text in remarks:
        typer.echo(printable(text), err=True)
    named = written if len(written) <= 4 else written[:1]
    for path in named:
        typer.echo(printable(path))
    if len(named) < len(written):
        typer.echo(f"… and {len(written) - len(named)} more files beside it")


def _written(pipeline: "Pipeline", task: str, output: Path | None) -> tuple[list[Path], list[str]]:
    """Where the files are, and the remarks on them."""
    from kinetree.pipeline import views
    from kinetree.pipeline.output.output import write_elsewhere, write_result
    from kinetree.pipeline.output.ownership import Owned

    schedule = pipeline.computed(task, LAID_OUT_BY).schedule
    done = [entry for entry in schedule.entries.values() if entry.node.task == task]
    remarks = list(dict.fromkeys(text for entry in done for text in views.remarks(schedule.value(entry.node))))
    if output is not None:
        return write_elsewhere(output, schedule, task, MESH_FILES), remarks
    owned = Owned.of(pipeline.config.output)
    return [owned.folder / name for entry in done for name in write_result(owned, schedule, entry)], remarks


def _write_schema(output: Path | None) -> None:
    from kinetree.tasks.results.formats.document import schema

    text = json.dumps(schema(), indent=2) + "\n"
    if output is None:
        typer.echo(text, nl=False)
        return
    try:
        output.write_text(text)
    except OSError as error:
        raise ConfigError(f"{output}: cannot be written: {error.strerror}; name another file") from None
    typer.echo(printable(output))
