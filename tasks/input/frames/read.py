"""What one frame holds, read when it is computed and refused where it is not what was planned."""

from functools import lru_cache
from pathlib import Path

import numpy as np

from kinetree.errors import SourceError, StoreError
from kinetree.pipeline.identity.key import array_digest, digest, file_digest
from kinetree.pipeline.storage.groups import is_array, opened_array, user_arrays
from kinetree.schemas.array import Bools as Flags
from kinetree.schemas.array import Floats, Ints
from kinetree.schemas.input.source import Source
from kinetree.tasks.numerics.input.animated import Animated, read_animated
from kinetree.tasks.numerics.input.calibration import Calibration, read_calibration
from kinetree.tasks.numerics.input.formats import read_mesh
from kinetree.tasks.numerics.input.silhouettes import read_masks, read_packed_masks
from kinetree.tasks.numerics.input.source import (
    ARRAYS,
    Frames,
    read_npz,
    refuse_unreadable,
)
from kinetree.tasks.numerics.input.volumes import Grid, Volumes, read_volume, read_volumes


def surface(frame_source: Source) -> tuple[Floats, Ints]:
    """Vertices (vertex, xyz) and faces (face, corner) of one frame, as the user gave them.

    raises : MeshError, SourceError where they cannot be read, or are not the bytes that were there when planning
    """
    path = Path(frame_source.path)
    if frame_source.part is not None and frame_source.kind == "synth":
        from kinetree.tasks.input.synth import body  # what generates bodies takes a second to import

        V, corners = body(frame_source.recipe).frame(frame_source.part)
        F = corners.astype(np.int32)
        now = digest(["synth", frame_source.recipe, frame_source.part])
    elif frame_source.part is None:
        refuse_unreadable(path)
        V, F = read_mesh(path)
        now = file_digest(path)
    else:
        V, F = packed_frames(path, frame_source.kind, frame_source.clip).mesh(frame_source.part)
        now = mesh_digest(V, F)
    _refuse_changed(now, frame_source)
    return V, F


def painted(frame_source: Source) -> Floats | None:
    """(vertex, rgb) sRGB from 0 to 1 of one frame of a synthetic sequence; None where it is not painted."""
    from kinetree.tasks.input.synth import body, paint

    colours = paint(frame_source.recipe)
    if colours is None or frame_source.part is None:
        return None
    return colours.colours(frame_source.part, *body(frame_source.recipe).frame(frame_source.part))


def silhouettes(frame_source: Source) -> tuple[Calibration, list[Flags | None]]:
    """The cameras, and the mask of each in one frame, None where it has none.

    raises : SourceError, HullError where they cannot be read, or are not the bytes that were there when planning
    """
    calibration = read_calibration([Path(path) for path in frame_source.calibration])
    packed = frame_source.part is None
    masks = (
        read_packed_masks(Path(frame_source.masks[0]), calibration)
        if packed
        else read_masks([Path(path) if path else None for path in frame_source.masks], calibration)
    )
    files = frame_source.calibration, frame_source.masks
    now = [[file_digest(Path(path)) if path else "" for path in paths] for paths in files]
    _refuse_changed(digest(["silhouettes", *now]), frame_source)
    return calibration, masks


def volume(frame_source: Source) -> Grid:
    """The volume of one frame, as the user gave it.

    raises : SourceError, HullError where it cannot be read, or is not the bytes that were there when planning
    """
    path = Path(frame_source.path)
    if frame_source.part is None:
        refuse_unreadable(path)
        grid = read_volume(path)
        _refuse_changed(file_digest(path), frame_source)
    else:
        grid = volumes(path).grid(frame_source.part)
        _refuse_changed(grid_digest(grid), frame_source)
    return grid


def name(frame_source: Source) -> str:
    """What messages call the frame."""
    file = Path(frame_source.path).name
    return file if frame_source.part is None else f"{file}, frame {frame_source.part}"


def _refuse_changed(now: str, frame_source: Source) -> None:
    if now != frame_source.content:
        raise SourceError(f"{name(frame_source)}: the file changed while the run was under way; run again")


def packed_frames(path: Path, kind: str, clip: str = "") -> Animated:
    """The frames of one file that holds all."""
    if kind in ("animated", "segment"):
        return read_animated(path, clip, is_segment=kind == "segment")
    return read_npz(path) if kind == "npz" else _zarr_frames(path, _state(path))


def _state(path: Path) -> tuple[tuple[str, int, int], ...]:
    """Name, size and time of every file of a group: what was read is remembered until one of them changes."""
    try:
        stats = [(str(file), file.stat()) for file in sorted(path.rglob("*"))]
    except OSError as error:
        raise SourceError(f"{path}: cannot be read: {error.strerror}; did it change while it was read?") from error
    return tuple((name, stat.st_size, stat.st_mtime_ns) for name, stat in stats)


@lru_cache(maxsize=2)
def _zarr_frames(path: Path, state: tuple[tuple[str, int, int], ...]) -> Frames:
    """The frames of a zarr group in this state."""
    try:
        return Frames.of(user_arrays(path, ARRAYS), str(path))
    except StoreError as error:  # the user's file, not the store
        raise SourceError(str(error)) from error


def volumes(path: Path) -> Volumes:
    """The volumes of one npy, npz or zarr array."""
    if not is_array(path):
        return read_volumes(path)
    try:
        return Volumes.of(*opened_array(path), str(path))
    except StoreError as error:  # the user's file, not the store
        raise SourceError(str(error)) from error


def mesh_digest(V: Floats, F: Ints) -> str:
    """Digest of one frame of a packed sequence."""
    return digest([array_digest(V), array_digest(F)])


def grid_digest(grid: Grid) -> str:
    """Digest of one frame of packed volumes."""
    return digest(["volume", array_digest(np.ascontiguousarray(grid.values)), grid.origin.tolist(), grid.spacing.tolist()])
