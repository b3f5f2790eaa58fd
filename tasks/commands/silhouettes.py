"""`kinetree silhouettes`: what a ring of cameras sees of a mesh sequence, as masks and a calibration."""

import os
import shutil
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from kinetree.errors import ConfigError

if TYPE_CHECKING:
    from kinetree.schemas.input.source import Source
    from kinetree.tasks.numerics.arrays import Floats


def silhouettes(
    meshes: Annotated[str, typer.Argument(metavar="INPUT", help="Folder or glob of meshes, or one .npz or zarr file.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder to write, new or empty.")] = Path("silhouettes"),
    cameras: Annotated[int, typer.Option("--cameras", min=2, help="How many, at even angles around the body.")] = 15,
    size: Annotated[int, typer.Option("--size", min=32, max=8192, help="Rows and columns of an image.")] = 512,
    elevation: Annotated[float, typer.Option("--elevation", min=-85, max=85, help="Degrees above the ring's plane.")] = 15.0,
    up: Annotated[str | None, typer.Option("--up", help="x, y or z; default: the longest side of the first frame.")] = None,
    frames: Annotated[str, typer.Option("--frames", metavar="START:STOP:STEP", help="Which frames, e.g. 10:60:2.")] = ":",
) -> None:
    """Render the silhouettes of a mesh sequence from a ring of cameras.

    Files: calibration.json, and a folder of masks for every camera: cam_00/frame_0000.png, … . A run reads them back.
    """
    from kinetree.pipeline.storage.files import Files
    from kinetree.pipeline.storage.store import Store
    from kinetree.schemas.input.source import SourceParams
    from kinetree.tasks.input.source import source

    if up not in (None, "x", "y", "z"):
        raise ConfigError(f"--up {up}: write x, y or z")
    if output.exists() and (not output.is_dir() or any(output.iterdir())):
        raise ConfigError(f"{output}: not an empty folder; name a new one, so that no mask of another sequence stays in it")
    if "://" in meshes:
        raise ConfigError(f"{meshes}: masks are rendered from a folder or file of this machine; copy the meshes there")
    listed = source(SourceParams(input=str(Path(meshes).absolute()), frames=frames), Files.of(Store.at(output)))
    if any(one.kind in ("silhouettes", "volume") for one in listed.values()):
        raise ConfigError(f"{meshes}: no meshes; silhouettes are rendered from a sequence of meshes")
    _write(dict(listed), output, cameras, size, elevation, None if up is None else "xyz".index(up))
    next_step = f"kinetree run --input {output} --output {output}-kinetree"
    typer.echo(f"{output}: {len(listed)} frames from {cameras} cameras; {next_step}")


def _write(listed: "dict[int, Source]", output: Path, cameras: int, size: int, elevation: float, up: int | None) -> None:
    """Writes every frame's masks and the calibration, all or nothing."""
    import numpy as np

    from kinetree.tasks.input.frames.read import surface
    from kinetree.tasks.numerics.input import cameras as numerics
    from kinetree.tasks.numerics.input.calibration import Calibration, written_calibration
    from kinetree.tasks.numerics.input.silhouettes import write_masks

    first = next(iter(listed.values()))
    low, high, longest = _extent(listed)
    ring = numerics.camera_ring(
        cameras, 0.5 * (low + high), 0.5 * float(((high - low) ** 2).sum() ** 0.5), (size, size), elevation,
        longest if up is None else up,
    )  # fmt: skip
    names = tuple(f"cam_{c:02d}" for c in range(cameras))
    beside = output.absolute().with_name(f".{output.name}.{os.getpid()}")
    try:
        beside.mkdir(parents=True)
        for frame, one in listed.items():
            V, F = surface(one)
            write_masks(beside, frame, names, numerics.silhouettes(V, F.astype(np.int64), ring))
        calibration = Calibration(names, ring.P, (ring.size,) * cameras, first.unit, first.fps)
        (beside / "calibration.json").write_text(written_calibration(calibration), encoding="utf-8")
        if output.is_dir():
            output.rmdir()
        beside.rename(output)
    except OSError as error:
        raise ConfigError(f"{output}: cannot be written: {error.strerror}") from error
    finally:
        shutil.rmtree(beside, ignore_errors=True)


def _extent(listed: "dict[int, Source]") -> "tuple[Floats, Floats, int]":
    """Lowest and highest corner of the box about all frames, and the longest axis of the first."""
    import numpy as np

    from kinetree.tasks.input.frames.read import surface

    boxes = np.array([(V.min(axis=0), V.max(axis=0)) for V, _ in map(surface, listed.values())])
    return boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0), int((boxes[0, 1] - boxes[0, 0]).argmax())
