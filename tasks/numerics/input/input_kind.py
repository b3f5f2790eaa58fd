"""What a path holds: meshes, silhouettes or volumes."""

import glob
from pathlib import Path
from typing import Literal

from kinetree.errors import SourceError
from kinetree.tasks.numerics.input import silhouettes, volumes
from kinetree.tasks.numerics.input.calibration import calibration_files
from kinetree.tasks.numerics.input.formats import suffixes
from kinetree.tasks.numerics.input.npz import npz_shapes
from kinetree.tasks.numerics.input.source import natural_order, regular

InputKind = Literal["meshes", "silhouettes", "packed silhouettes", "volumes", "packed volumes"]


def input_kind(where: str) -> tuple[InputKind, list[Path]]:
    """What lies at a path or pattern, and the files of it, one a frame, in natural order.

    Meshes come first: silhouettes or volumes beside meshes are chosen by a pattern such as walk/volume_*.npz.

    returns : kind · files; none for meshes and for silhouettes in folders, the one file for what is packed
    raises  : SourceError if an npz cannot be read
    """
    path = Path(where).expanduser()
    if path.is_dir():
        there = [p for p in path.iterdir() if not p.name.startswith(".")]
        if any(p.suffix.lower() in suffixes() for p in there):
            return "meshes", []
        if silhouettes.camera_folders(path):
            return "silhouettes", []
        known = set(calibration_files(path))
        return _of_files([p for p in there if p not in known])
    if glob.has_magic(str(path)):
        return _of_files([Path(p) for p in glob.glob(str(path), recursive=True)])  # noqa: PTH207
    if path.is_file() and path.suffix.lower() == ".npy":
        return "packed volumes", [path]
    if path.is_file() and path.suffix.lower() == ".npz":
        shapes = npz_shapes(path)
        if "vertices" not in shapes and any(len(shapes.get(name, ())) == 4 for name in volumes.ARRAYS):
            return "packed volumes", [path]
    return "meshes", []


def _of_files(there: list[Path]) -> tuple[InputKind, list[Path]]:
    """Silhouettes or volumes among the files of one suffix; meshes where they are neither."""
    files = [p for p in there if p.is_file()]
    kinds = {p.suffix.lower() for p in files}
    frame_files = sorted(files, key=lambda p: [natural_order(part) for part in p.parts])
    if len(kinds) != 1 or not kinds <= set(volumes.SUFFIXES):
        if kinds and kinds <= set(silhouettes.SUFFIXES):
            raise SourceError(
                f"{frame_files[0].parent}: images, but no folder for each camera; "
                "silhouettes are CAMERA/FRAME.png and a calibration"
            )
        return "meshes", []
    regular(there, kinds)
    if kinds == {".npz"} and silhouettes.ARRAY in npz_shapes(frame_files[0]):
        return "packed silhouettes", frame_files
    return "volumes", frame_files
