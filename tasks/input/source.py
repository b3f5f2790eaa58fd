"""Where the frames are: a folder or glob of mesh files, one npz or zarr file that holds them all, or a synthetic body."""

import json
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path

import numpy as np

from kinetree.errors import SourceError, StoreError
from kinetree.pipeline.files import Files
from kinetree.pipeline.key import array_digest, digest, file_digest
from kinetree.pipeline.store import group_arrays
from kinetree.pipeline.task import origin
from kinetree.schemas.array import Floats, Ints
from kinetree.schemas.input.source import Source, SourceParams
from kinetree.tasks.input.synth import body, recipe
from kinetree.tasks.numerics.input.formats import read_mesh
from kinetree.tasks.numerics.input.source import Frames, mesh_files, read_npz


@origin(over="frame")
def source(params: SourceParams, files: Files) -> Mapping[int, Source]:
    """Finds the frames of a sequence and the digest of each one's bytes (2014, Sec. 3)."""
    if params.synth is not None:
        if params.input:
            raise SourceError(f"source.input ({params.input}) and source.synth exclude each other; leave one out")
        return _chosen(_generated(recipe(params.synth), params.synth.frames), params.frames, "the synthetic sequence")
    if not params.input:
        raise SourceError("no input: name a folder of meshes with --input, or source.input in the config")
    return _chosen(_found(params.input, files), params.frames, params.input)


def _found(where: str, files: Files) -> list[Source]:
    """Every frame at a path, a pattern or in a packed sequence."""
    path = _written(Path(where))
    if path.suffix == ".npz" or _is_zarr(path):
        return _packed(path, "npz" if path.suffix == ".npz" else "zarr", files)
    paths = [_written(p) for p in mesh_files(where)]
    contents = files.digests(paths)
    return [Source(content=c, path=str(p)) for c, p in zip(contents, paths, strict=True)]


def _generated(written: str, frames: int) -> list[Source]:
    """Every frame of a synthetic sequence."""
    generated = body(written)
    unit, fps = generated.figure.unit, generated.fps
    return [
        Source(content=digest(["synth", written, t]), path="synth", part=t, kind="synth", recipe=written, fps=fps, unit=unit)
        for t in range(frames)
    ]


def _chosen(sources: Sequence[Source], frames: str, where: str) -> dict[int, Source]:
    """The frames wanted, by number."""
    chosen = _selected(frames, len(sources), where)
    if len(chosen) < 2:
        held = f"frames {frames!r} selects" if len(sources) > 1 else f"{where}: there is"
        raise SourceError(f"{held} a single frame; kinematics are seen in motion, give at least two frames")
    return {frame: sources[frame] for frame in chosen}


def surface(frame_source: Source) -> tuple[Floats, Ints]:
    """Vertices (vertex, xyz) and faces (face, corner) of one frame, as the user gave them.

    raises : MeshError, SourceError where they cannot be read, or are not the bytes that were there when planning
    """
    path = Path(frame_source.path)
    if frame_source.part is not None and frame_source.kind == "synth":
        V, corners = body(frame_source.recipe).frame(frame_source.part)
        F = corners.astype(np.int32)
        now = digest(["synth", frame_source.recipe, frame_source.part])
    elif frame_source.part is None:
        _refuse_closed(path)
        V, F = read_mesh(path)
        now = file_digest(path)
    else:
        V, F = _packed_frames(path, frame_source.kind).mesh(frame_source.part)
        now = _mesh_digest(V, F)
    if now != frame_source.content:
        raise SourceError(f"{name(frame_source)}: the file changed while the run was under way; run again")
    return V, F


def name(frame_source: Source) -> str:
    """What messages call the frame."""
    file = Path(frame_source.path).name
    return file if frame_source.part is None else f"{file}, frame {frame_source.part}"


def _packed_frames(path: Path, kind: str) -> Frames:
    """The frames of one npz or zarr file."""
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
        return Frames.of(group_arrays(path), str(path))
    except StoreError as error:  # the user's file, not the store
        raise SourceError(str(error)) from error


def _mesh_digest(V: Floats, F: Ints) -> str:
    """Digest of one frame of a packed sequence."""
    return digest([array_digest(V), array_digest(F)])


def _packed(path: Path, kind: str, files: Files) -> list[Source]:
    """Every frame of one npz or zarr file."""
    if not path.exists():
        raise SourceError(f"{path}: there is no such file")

    def parts(where: Path) -> Sequence[str]:
        frames = _packed_frames(where, kind)
        heads = [json.dumps(frames.fps), json.dumps(frames.unit)]
        return heads + [_mesh_digest(*frames.mesh(t)) for t in range(len(frames))]

    fps, unit, *contents = files.parts(path, f"{kind}/2", parts)
    stated = {"path": str(path), "kind": kind, "fps": json.loads(fps), "unit": json.loads(unit)}
    return [Source(content=c, part=t, **stated) for t, c in enumerate(contents)]


def _written(path: Path) -> Path:
    """The path, if its name can be written down; raises SourceError where its bytes are no text."""
    try:
        str(path).encode()
    except UnicodeEncodeError:
        raise SourceError(f"{str(path)!r}: this name is not valid UTF-8; rename the file or folder") from None
    return path


def _is_zarr(path: Path) -> bool:
    try:
        return any((path / name).is_file() for name in ("zarr.json", ".zgroup"))
    except OSError as error:
        raise SourceError(f"{path}: cannot be read: {error.strerror}; check its name and its permissions") from None


def _refuse_closed(path: Path) -> None:
    """A file that may not be read is not a damaged one."""
    try:
        path.open("rb").close()
    except FileNotFoundError:
        return
    except OSError as error:
        raise SourceError(f"{path}: cannot be read: {error.strerror}; check its permissions") from None


def _selected(text: str, count: int, where: str) -> range:
    """The frames that start:stop:step selects of `count`; raises SourceError where it is no range or selects nothing."""
    parts = text.split(":")
    try:
        start, stop, step = ([int(p) if p.strip() else None for p in parts] + [None, None])[:3]
        if len(parts) not in (2, 3):
            raise ValueError
        chosen = range(count)[slice(start, stop, step)]
    except ValueError:
        raise SourceError(f"frames {text!r}: write start:stop or start:stop:step, e.g. 10:60:2") from None
    if step is not None and step < 0:
        raise SourceError(f"frames {text!r}: the step must be positive; time runs forward")
    if not chosen:
        raise SourceError(f"frames {text!r} selects none of the {count} frames of {where}")
    return chosen
