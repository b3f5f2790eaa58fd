"""`kinetree convert`: a file that only Blender opens as a sequence that a run reads."""

import math
import os
import shutil
import signal
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated, Any

import typer

from kinetree.errors import ConfigError, InputError
from kinetree.errors.small_text import small_json, small_text
from kinetree.pipeline.command_line.printable import printable
from kinetree.tasks.commands.blender_frames import SAMPLED, SCRIPT, SUFFIXES

MOST_FRAMES = 100_000
DEFAULT_FPS = 24.0
MOST_LAYOUT = 2**24
"""Bytes of what the script says of the frames: of as many as there may be, some two million."""
SAFELY = ("--background", "--factory-startup", "--disable-autoexec", "--python-exit-code", "3")
"""No settings, add-ons or start-up files of the user's, and no scripts or drivers of the file; the module bpy begins so."""


def convert(
    file: Annotated[Path, typer.Argument(metavar="FILE", help=f"One of {' '.join(SUFFIXES)}, with its motion.")],
    output: Annotated[Path | None, typer.Option("--output", "-o", help="File to write, new; default: FILE as .npz.")] = None,
    blender: Annotated[
        str | None,
        typer.Option(
            "--blender",
            metavar="PROGRAM",
            envvar="KINETREE_BLENDER",
            help="Blender, or a Python that has Blender as its module bpy; default: bpy beside kinetree, else blender.",
        ),
    ] = None,
    fps: Annotated[
        float | None,
        typer.Option("--fps", min=1, max=1000, help="Frames a second of an Alembic file, which keeps times; default: 24."),
    ] = None,
    seconds: Annotated[float, typer.Option("--seconds", min=1, help="Longest that Blender may take.")] = 600.0,
) -> None:
    """Let Blender make a sequence of an FBX, Alembic, Collada, X3D or Blender file.

    All frames become one file that a run reads. The file's own scripts and drivers do not run. Every mesh that would be
    rendered counts, with all that moves it; frames are those of the animation, of a Blender file those of its scene. Lengths
    are metres, z is up.
    """
    if file.suffix.lower() not in SUFFIXES:
        raise ConfigError(f"{file}: {file.suffix or 'no suffix'} is not converted; {' '.join(SUFFIXES)} are")
    if fps is not None and file.suffix.lower() not in SAMPLED:
        raise ConfigError(f"--fps {fps:g}: {file.suffix} has frames of its own; only {' '.join(SAMPLED)} is sampled")
    if not file.is_file():
        raise InputError(f"{file}: {'not a file' if file.exists() else 'there is no such file'}")
    target = output or file.with_suffix(".npz")
    if target.suffix != ".npz":
        raise ConfigError(f"{target}: write a name that ends in .npz; name a new file")
    _refuse_taken(target)
    if not target.parent.is_dir():
        raise ConfigError(f"{target}: there is no folder {target.parent}; make it, or name another file")
    starter = _starter(blender, file.suffix)
    with tempfile.TemporaryDirectory() as folder:
        _run(starter, [str(file.absolute()), folder, str(MOST_FRAMES), str(fps or DEFAULT_FPS)], Path(folder), seconds)
        frames = _pack(Path(folder), file, target)
    if fps is None and file.suffix.lower() in SAMPLED:
        typer.echo(f"sampled {DEFAULT_FPS:g} times a second; say --fps where it was recorded at another rate", err=True)
    typer.echo(
        printable(f"{target}: {frames} frames; kinetree run --input {target} --output {target.with_suffix('')}-kinetree")
    )


def _refuse_taken(target: Path) -> None:
    """Nothing that is there is written over, a link to nothing neither."""
    if target.exists() or target.is_symlink():
        raise ConfigError(f"{target}: already there; name a new file")


def _starter(blender: str | None, suffix: str) -> tuple[str, ...]:
    """The command before the script: the program, or a Python whose module bpy is Blender; ConfigError without either."""
    if blender is None and find_spec("bpy") is not None:
        return (sys.executable,)
    program = shutil.which(blender or "blender")
    if program is None:
        raise ConfigError(
            f"{suffix} is opened by Blender, which is not installed here ({blender or 'blender'}); install it (or pip install"
            " bpy), or name it with --blender; or export the file as GLB with its animation elsewhere"
        )
    starter = str(Path(program).absolute())
    return (starter,) if Path(program).name.startswith("python") else (starter, *SAFELY, "--python")


def _run(starter: tuple[str, ...], arguments: list[str], folder: Path, seconds: float) -> None:
    """Runs the script in Blender with its arguments, the file first, in a group of processes of its own that ends with it."""
    script = folder / "frames.py"
    script.write_text(SCRIPT)
    command, file = [*starter, str(script), "--", *arguments], arguments[0]
    with (folder / "log").open("w+b") as log:
        process = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=log, stderr=log, start_new_session=True, cwd=folder
        )
        try:
            code = process.wait(seconds)
        except subprocess.TimeoutExpired:
            raise InputError(f"{file}: Blender did not finish within {seconds:g} s; give it more with --seconds") from None
        finally:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()
    refused = folder / "refused.txt"
    if refused.exists():
        raise InputError(f"{file}: {refused.read_text()}")
    if code != 0 or not (folder / "layout.json").exists():
        lines = [line for line in (folder / "log").read_text("utf-8", "replace").splitlines() if _tells(line)]
        raise InputError(f"{file}: Blender cannot open it ({lines[-1].strip()[:200] if lines else f'exit code {code}'})")


def _pack(folder: Path, file: Path, target: Path) -> int:
    """Writes what Blender left as .npz, all or nothing, and returns the number of frames."""
    import numpy as np

    layout = small_json(small_text(folder / "layout.json", InputError, MOST_LAYOUT), f"{file}: what Blender says", InputError)
    try:
        counts, fps, scale = (
            np.array(layout["counts"], dtype=np.int64).reshape(-1, 2),
            float(layout["fps"]),
            float(layout["scale"]),
        )
    except (KeyError, TypeError, ValueError, OverflowError) as error:
        raise InputError(f"{file}: what Blender says: counts, scale and fps are needed ({error!r})") from None
    if not (0 < fps < math.inf and 0 < scale < math.inf):
        raise InputError(f"{file}: its scene has {fps:g} frames a second and a unit of {scale:g} m; set both in Blender")
    if not len(counts) or (counts < 1).any():
        raise InputError(
            f"{file}: no surface in {'any frame' if not counts.any() else 'some frames'}; a mesh that is rendered is needed"
        )
    if len(counts) == 1:
        raise InputError(f"{file}: a single frame; kinematics are seen in motion, and nothing in the file moves")
    ends = np.vstack([[0, 0], np.cumsum(counts, axis=0)])
    paths, needed = (folder / "vertices", folder / "faces"), [12 * int(end) for end in ends[-1]]
    sizes = [path.stat().st_size if path.exists() else 0 for path in paths]
    if sizes != needed:
        raise InputError(
            f"{file}: Blender left {sizes[0]} bytes of vertices and {sizes[1]} of faces, not {needed[0]} and {needed[1]};"
            f" is the disk of {folder.parent} full?"
        )
    V = np.fromfile(paths[0], np.float32).reshape(-1, 3).astype(np.float64) * scale
    F = np.fromfile(paths[1], np.int32).reshape(-1, 3)
    arrays: dict[str, Any] = {"vertices": V, "faces": F, "vertex_offsets": ends[:, 0], "face_offsets": ends[:, 1]}
    arrays |= {"fps": fps, "unit": "m"}
    beside = target.with_name(f".{target.stem}.{os.getpid()}.npz")
    try:
        np.savez_compressed(beside, **arrays)
        _refuse_taken(target)
        beside.rename(target)
    except OSError as error:
        raise ConfigError(f"{target}: cannot be written: {error.strerror}; name another file") from None
    finally:
        beside.unlink(missing_ok=True)
    return len(counts)


def _tells(line: str) -> bool:
    """Whether a line of Blender's log says what is wrong with the file, and not where the script stood."""
    return "Error" in line and not any(other in line for other in ("script failed", "Traceback", "EGL"))
