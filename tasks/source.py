"""Where the frames are: a folder or glob of mesh files, or one npz or zarr file that holds them all."""

from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path

from kinetree.pipeline.errors import SourceError
from kinetree.pipeline.files import Files
from kinetree.pipeline.key import array_digest, digest, file_digest
from kinetree.pipeline.store import group_arrays
from kinetree.pipeline.task import origin
from kinetree.schemas.array import Floats, Ints
from kinetree.schemas.source import Source, SourceParams
from kinetree.tasks.numerics.source import Frames, mesh_files, read_mesh, read_npz


@origin(over="frame")
def source(params: SourceParams, files: Files) -> Mapping[int, Source]:
    """Finds the frames of a sequence and the digest of each one's bytes (2014, Sec. 3)."""
    if not params.input:
        raise SourceError("no input: name a folder of meshes with --input, or source.input in the config")
    path = Path(params.input)
    if path.suffix == ".npz" or _is_zarr(path):
        found = _packed(path, "npz" if path.suffix == ".npz" else "zarr", files)
    else:
        paths = mesh_files(params.input)
        contents = files.digests(paths)
        found = [Source(content=c, path=str(p)) for c, p in zip(contents, paths, strict=True)]
    return {frame: found[frame] for frame in _selected(params.frames, len(found), params.input)}


def surface(found: Source) -> tuple[Floats, Ints]:
    """Vertices (vertex, xyz) and faces (face, corner) of one frame, as the user gave them.

    raises : MeshError, SourceError where they cannot be read, or are not the bytes that were there when planning
    """
    path = Path(found.path)
    if found.part is None:
        V, F = read_mesh(path)
        now = file_digest(path)
    else:
        V, F = _packed_frames(path, found.kind).mesh(found.part)
        now = _mesh_digest(V, F)
    if now != found.content:
        raise SourceError(f"{name(found)}: the file changed while the run was under way; run again")
    return V, F


def name(found: Source) -> str:
    """What messages call the frame."""
    file = Path(found.path).name
    return file if found.part is None else f"{file}, frame {found.part}"


def _packed_frames(path: Path, kind: str) -> Frames:
    return read_npz(path) if kind == "npz" else _zarr_frames(path, (path / "zarr.json").stat().st_mtime_ns)


@lru_cache(maxsize=2)
def _zarr_frames(path: Path, modified: int) -> Frames:
    return Frames.of(group_arrays(path), str(path))


def _mesh_digest(V: Floats, F: Ints) -> str:
    return digest([array_digest(V), array_digest(F)])


def _packed(path: Path, kind: str, files: Files) -> list[Source]:
    if not path.exists():
        raise SourceError(f"{path}: there is no such file")

    def parts(where: Path) -> Sequence[str]:
        frames = _packed_frames(where, kind)
        heads = [f"{frames.fps!r}", f"{frames.unit!r}"]
        return heads + [_mesh_digest(*frames.mesh(t)) for t in range(len(frames))]

    fps, unit, *contents = files.parts(path, kind, parts)
    return [
        Source(content=c, path=str(path), part=t, kind=kind, fps=_number(fps), unit=_text(unit)) for t, c in enumerate(contents)
    ]


def _number(told: str) -> float | None:
    return None if told == "None" else float(told)


def _text(told: str) -> str | None:
    return None if told == "None" else told[1:-1]


def _is_zarr(path: Path) -> bool:
    return any((path / name).is_file() for name in ("zarr.json", ".zgroup"))


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
