"""`kinetree export`: the result of a run as a file that other programs open."""

import json
from collections.abc import Collection
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from kinetree.errors import ConfigError
from kinetree.errors.small_text import small_text
from kinetree.pipeline.command_line.options import AsJson, Set, Target, pipeline_of, print_json, tell
from kinetree.pipeline.command_line.printable import printable
from kinetree.pipeline.suggest import nearest

if TYPE_CHECKING:
    from kinetree.pipeline.inspect import Pipeline
    from kinetree.pipeline.planning.schedule import Schedule
    from kinetree.schemas.structure.joint_names import JointNames

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
LARGEST_NAMES = 2**20
"""Bytes of a file of names."""
LONGEST_NAME = 100
"""Letters of one name: other programs keep 63 of them."""
EXTRAS = {"usd": "pxr", "c3d": "ezc3d"}
"""The module without which a format cannot be written; the extra that brings it has the format's name."""
BY_BLENDER = ("fbx", "blend")
"""Formats that no kept Python package writes."""
SCHEMA = "json-schema"
NAMES = "names"
"""What is written though no task writes it: the schema of skeleton.json, and names of joints for --names."""
MESH_FILES = (".ply", ".obj", ".off", ".stl", ".glb", ".gltf")
"""Endings of meshes: one more of these in the folder of the input would be read as a frame or refused."""
ENDINGS = {"usd": (".usda", ".usd"), NAMES: (".yaml", ".yml", ".txt"), SCHEMA: (".json",)}
"""Endings of a single file, where the run's own file does not say which is the only one."""


def export(
    run: Target = None,
    to: Annotated[str, typer.Option("--to", metavar="FORMAT", help=f"{', '.join(FORMATS)}, {NAMES} or {SCHEMA}.")] = "glb",
    output: Annotated[
        Path | None, typer.Option("--output", "-o", metavar="PATH", help="File or folder; default: the run's own folder.")
    ] = None,
    sets: Set = None,
    as_json: AsJson = False,
    names: Annotated[
        str | None,
        typer.Option(
            "--names",
            metavar="STYLE|FILE",
            help="Names of joints: kinetree, mixamo, smpl, openpose, vrm, isb or none; or a file as --to names writes it.",
        ),
    ] = None,
) -> None:
    """Write the result of a run as a file for other programs.

    Nothing but the file is computed, and what names and completes the joints in it.

    glb and usd hold the skinned, moving body, blender the same with a script that makes FBX of it, bvh the motion, json the
    joints, trc and c3d the joints as markers, csv tables of motion, angles, lengths and steps, ply your own meshes coloured
    by part, rignet the rig as text, zarr part labels and aligned meshes. names is a text to edit: the names of all joints,
    which --names FILE takes.
    """
    if to.lower() in BY_BLENDER:
        raise ConfigError(f"--to {to}: Blender writes it, by the script that --to blender leaves beside the body")
    if to not in (*FORMATS, NAMES, SCHEMA):
        raise ConfigError(f"--to {to}: no such format; {nearest(to, (*FORMATS, NAMES, SCHEMA))}")
    if to == SCHEMA:
        from kinetree.tasks.results.formats.document import schema

        _write_text(json.dumps(schema(), indent=2) + "\n", output, ENDINGS[SCHEMA])
        return
    if to in EXTRAS and find_spec(EXTRAS[to]) is None:
        raise ConfigError(f"--to {to} needs a package that is not installed: pip install 'kinetree[{to}]' brings it")
    pipeline = pipeline_of(run, sets=[*(sets or ()), *(() if names is None else (_names_setting(names),))])
    if to == NAMES:
        _write_text(_names_text(pipeline), output, ENDINGS[NAMES])
        return
    written, remarks = _written(pipeline, to, output, names)
    if as_json:
        print_json({"files": [str(path) for path in written], "remarks": remarks})
        return
    for text in remarks:
        tell(text)
    named = written if len(written) <= 4 else written[:1]
    for path in named:
        typer.echo(printable(path))
    if len(named) < len(written):
        typer.echo(f"… and {len(written) - len(named)} more files beside it")


def _written(pipeline: "Pipeline", to: str, output: Path | None, names: str | None) -> tuple[list[Path], list[str]]:
    """Where the files are, and the remarks on them and on what --names names."""
    from kinetree.pipeline import views
    from kinetree.pipeline.output.output import write_elsewhere, write_result
    from kinetree.pipeline.output.ownership import Owned
    from kinetree.schemas.structure.joint_names import STYLES
    from kinetree.tasks.views.structure import renaming_remarks

    task = FORMATS[to]
    there = pipeline.computed(task, LAID_OUT_BY)
    schedule = there.schedule
    done = [entry for entry in schedule.entries.values() if entry.node.task == task]
    remarks_made = dict.fromkeys(text for entry in done for text in views.remarks(schedule.value(entry.node)))
    remarks = [*([there.unkept] if there.unkept else []), *remarks_made]
    if (named := _joint_names(schedule)) is not None:
        remarks += renaming_remarks("joint_names.rename" if names is None or names in STYLES else names, named, (to,))
    if output is not None:
        return write_elsewhere(output, schedule, task, MESH_FILES, ENDINGS.get(to)), remarks
    owned = Owned.of(pipeline.config.output)
    return [owned.folder / name for entry in done for name in write_result(owned, schedule, entry)], remarks


def _names_setting(names: str) -> str:
    """What --names sets: a style, or the names in a file."""
    from kinetree.pipeline.settings.yaml_text import parsed
    from kinetree.schemas.structure.joint_names import STYLES

    if names in STYLES:
        return f"joint_names.style={names}"
    path = Path(names)
    if not path.is_file():
        raise ConfigError(f"--names {names}: neither a style nor a file; {nearest(names, STYLES)}")
    given_names = parsed(small_text(path, ConfigError, LARGEST_NAMES), names)
    pairs = given_names.items() if isinstance(given_names, dict) else [(None, None)]
    if not all(isinstance(text, str) and text for pair in pairs for text in pair):
        raise ConfigError(
            f"{names}: expected a line 'joint: name' for each joint; write the file with --to {NAMES}, then edit it"
        )
    if long := next((name for name in given_names.values() if len(name) > LONGEST_NAME), None):
        raise ConfigError(f"{names}: the name {long[:20]}… has {len(long)} letters; {LONGEST_NAME} are the most")
    return f"joint_names.rename={json.dumps(given_names)}"


def _names_text(pipeline: "Pipeline") -> str:
    """Every joint's own name and the name that files have, as YAML."""
    from kinetree.pipeline.settings.yaml_text import dumped

    there = pipeline.computed("joint_names", LAID_OUT_BY)
    if there.unkept:
        tell(there.unkept)
    joint_names = _joint_names(there.schedule)
    assert joint_names is not None
    return dumped(dict(zip(joint_names.given, joint_names.names, strict=True)), sort_keys=False)


def _joint_names(schedule: "Schedule") -> "JointNames | None":
    """The names of all joints; None where the schedule has none."""
    nodes = (e.node for e in schedule.entries.values() if e.node.task == "joint_names" and e.artifact is not None)
    return next((cast("JointNames", schedule.value(node)) for node in nodes), None)


def _write_text(text: str, output: Path | None, endings: Collection[str]) -> None:
    from kinetree.pipeline.output.output import refuse_ending

    if output is None:
        typer.echo(text, nl=False)
        return
    refuse_ending(output, endings)
    try:
        output.write_text(text, "utf-8")
    except OSError as error:
        raise ConfigError(f"{output}: cannot be written: {error.strerror}; name another file") from None
    typer.echo(printable(output))
