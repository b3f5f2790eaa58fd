"""Every frame at a path, a pattern, in a bucket or in one file that holds all, by number."""

import contextlib
import json
from collections.abc import Iterator, Sequence
from pathlib import Path, PurePath, PurePosixPath

from kinetree.errors import MeshError, SourceError
from kinetree.pipeline.identity.key import digest
from kinetree.pipeline.storage.files import Files
from kinetree.pipeline.storage.groups import is_array
from kinetree.schemas.input.source import Kind, Source
from kinetree.tasks.input.frames.measured import REMOTE, content_and_measures, memory
from kinetree.tasks.input.frames.read import grid_digest, mesh_digest, packed_frames, volumes
from kinetree.tasks.numerics.input.animated import SUFFIXES as ANIMATED
from kinetree.tasks.numerics.input.animated import Animated
from kinetree.tasks.numerics.input.calibration import NAMES, Calibration, calibration_files, read_calibration
from kinetree.tasks.numerics.input.formats import MOST_BYTES
from kinetree.tasks.numerics.input.formats import suffixes as mesh_suffixes
from kinetree.tasks.numerics.input.frame_numbers import are_frame_numbers, frame_numbers
from kinetree.tasks.numerics.input.input_kind import input_kind
from kinetree.tasks.numerics.input.silhouettes import MOST_BYTES as MOST_MASK_BYTES
from kinetree.tasks.numerics.input.silhouettes import mask_files
from kinetree.tasks.numerics.input.source import (
    mesh_files,
    one_format,
    written,
)
from kinetree.tasks.numerics.input.volumes import MOST_BYTES as MOST_VOLUME_BYTES
from kinetree.tasks.numerics.input.volumetric_manifest import SUFFIXES as MANIFESTS
from kinetree.tasks.numerics.input.volumetric_manifest import manifest_in, read_manifest
from kinetree.tasks.numerics.input.zipped import Zipped


def frames_at(where: str, files: Files, clip: str = "") -> dict[int, Source]:
    """Every frame at a path, a pattern or in a packed sequence, by number."""
    if clip and not where.lower().endswith(".glb") and _manifest(Path(where)) is None:
        needs = "names an animation of one GLB or a target of a volumetric manifest"
        raise SourceError(f"source.clip {clip}: {needs}, and {where} is none; leave it out")
    if files.is_remote(where):
        return _in_bucket(where, files, clip)
    if "://" in where:
        raise SourceError(f"{where.partition('://')[0]}:// is not read; give a folder, a pattern, a file or s3://bucket/folder")
    path = written(Path(where))
    if path.suffix.lower() in ANIMATED and path.is_file():
        return _animated(path, clip, files)
    if (manifest := _manifest(path)) is not None:
        return volumetric_frames(manifest, clip, files)
    if _is_zarr(path):
        return dict(enumerate(_packed_volumes(path, files) if is_array(path) else _packed(path, "zarr", files)))
    kind, kind_files = input_kind(where)
    if kind == "silhouettes":
        return _silhouettes(path, files)
    if kind == "packed silhouettes":
        kind_files = _complete([written(p) for p in kind_files], where, files)
        return _numbered(_packed_silhouettes(kind_files, files), kind_files)
    if kind == "packed volumes" or (kind == "meshes" and path.suffix == ".npz"):
        return dict(enumerate(_packed_volumes(path, files) if kind == "packed volumes" else _packed(path, "npz", files)))
    paths = _complete([written(p) for p in (kind_files if kind == "volumes" else mesh_files(where))], where, files)
    form: Kind = "volume" if kind == "volumes" else "file"
    contents = files.digests(paths, MOST_VOLUME_BYTES if kind == "volumes" else MOST_BYTES)
    return _numbered([Source(content=c, path=str(p), kind=form) for c, p in zip(contents, paths, strict=True)], paths)


def volumetric_frames(path: Path, clip: str, files: Files) -> dict[int, Source]:
    """Every frame of a Universal Volumetric 2 sequence, numbered as its files are; those of segments one after the other."""
    manifest = read_manifest(path, clip, is_growing=files.settling is not None)
    number = dict(zip(manifest.files, manifest.numbers, strict=True))
    paths = _complete([written(p) for p in manifest.files], str(path), files)
    stated = {"fps": manifest.fps}
    if manifest.holds == "file":
        contents = files.digests(paths, MOST_BYTES)
        sources = [Source(content=c, path=str(p), **stated) for c, p in zip(contents, paths, strict=True)]
        return {number[p]: frame for p, frame in zip(paths, sources, strict=True)}
    segments = {p: _packed(p, "segment", files) for p in paths}
    if longer := [p for p, frames in segments.items() if len(frames) > manifest.length]:
        raise SourceError(
            f"{longer[0]}: {len(segments[longer[0]])} frames, but {path.name} says that a file has {manifest.length}"
            " (segmentFrameCount); correct it"
        )
    return {
        number[p] * manifest.length + k: frame.model_copy(update=stated)
        for p, frames in segments.items()
        for k, frame in enumerate(frames)
    }


def _manifest(path: Path) -> Path | None:
    """The volumetric manifest that a path is, or that lies in a folder."""
    with _refusals(path):
        if path.suffix.lower() in MANIFESTS and path.is_file():
            return path
        if not path.is_dir() or _is_zarr(path):
            return None
        return manifest_in(path, beside_meshes=any(p.suffix.lower() in mesh_suffixes() for p in path.iterdir()))


def _animated(path: Path | str, clip: str, files: Files) -> dict[int, Source]:
    """Every frame of one file that holds a moving surface; a zip's have the numbers of their names."""
    sources = _packed(path, "animated", files, clip)
    if PurePath(path).suffix.lower() != ".zip":
        return dict(enumerate(sources))
    names = files.parts(path, "names/1", lambda where: [str(name) for name in Zipped(where).names])
    return _numbered(sources, [PurePosixPath(name) for name in names])


def _in_bucket(where: str, files: Files, clip: str) -> dict[int, Source]:
    """Every frame of a folder or pattern of mesh files in a bucket, or of one file there that holds all."""
    addresses = files.addresses(where)
    named = {PurePosixPath(address.partition("://")[2]): address for address in addresses}
    suffixes = {path.suffix.lower() for path in named}
    if suffixes == {".npz"} and len(addresses) == 1:
        return dict(enumerate(_packed(addresses[0], "npz", files)))
    if len(addresses) == 1 and suffixes <= set(ANIMATED):
        return _animated(addresses[0], clip, files)
    if not suffixes & set(mesh_suffixes()):
        raise SourceError(
            f"{where}: no mesh among its files ({', '.join(sorted(suffixes))}); in a bucket a folder or pattern of mesh files"
            f" ({' '.join(mesh_suffixes())}) or one npz is read; silhouettes, volumes, manifests and zarr are read from folders"
        )
    paths = one_format(list(named), where)
    parts = files.parts_of_each([named[path] for path in paths], REMOTE, content_and_measures)
    sources = [Source(content=content, path=named[path]) for path, (content, _) in zip(paths, parts, strict=True)]
    return _numbered(sources, paths)


def _complete(paths: Sequence[Path], where: str, files: Files) -> list[Path]:
    """The files that are complete, of an input that may grow; raises SourceError where none is."""
    complete = files.complete(paths)
    if not complete:
        raise SourceError(f"{where}: no file is complete yet")
    return complete


def _numbered(sources: Sequence[Source], paths: Sequence[PurePath]) -> dict[int, Source]:
    """The frames of numbered files, by number."""
    return dict(zip(frame_numbers(paths), sources, strict=True))


def _packed(path: Path | str, kind: Kind, files: Files, clip: str = "") -> list[Source]:
    """Every frame of one file that holds all, also of one in a bucket."""
    if isinstance(path, Path) and not path.exists():
        raise SourceError(f"{path}: there is no such file")

    def parts(where: Path) -> Sequence[str]:
        frames = packed_frames(where, kind, clip)
        heads = [json.dumps(frames.fps), json.dumps(frames.unit)]
        return heads + [_part_digest(frames, t) for t in range(len(frames))]

    every = Source(content="", path=str(path), kind=kind, clip=clip)
    fps, unit, *contents = files.parts(path, memory(every, "2"), parts)
    stated = {"fps": json.loads(fps), "unit": json.loads(unit)}
    return [every.model_copy(update={"content": c, "part": t, **stated}) for t, c in enumerate(contents)]


def _part_digest(frames: Animated, t: int) -> str:
    """Digest of one frame; "unreadable: …" for one that cannot be read, so that its node can say so."""
    try:
        return mesh_digest(*frames.mesh(t))
    except (MeshError, SourceError) as error:
        return f"unreadable: {error}"


def _silhouettes(folder: Path, files: Files) -> dict[int, Source]:
    """Every frame of a folder with a folder of images for every camera."""
    calibrated, calibration, contents = _calibrated(folder, files)
    frames = [(number, masks) for number, masks in mask_files(folder, calibration) if _are_complete(masks, files)]
    if not frames:
        raise SourceError(f"{folder}: no frame is complete yet")
    digests = dict(
        zip(
            paths := [written(p) for _, masks in frames for p in masks if p], files.digests(paths, MOST_MASK_BYTES), strict=True
        )
    )
    sources = [
        Source(
            content=digest(["silhouettes", contents, [digests[p] if p else "" for p in masks]]),
            path=str(folder),
            part=number,
            kind="silhouettes",
            calibration=calibrated,
            masks=tuple(str(p or "") for p in masks),
            fps=calibration.fps,
            unit=calibration.unit,
        )
        for number, masks in frames
    ]
    numbers = [number for number, _ in frames]
    return dict(zip(numbers if are_frame_numbers(numbers) else range(len(sources)), sources, strict=True))


def _are_complete(masks: Sequence[Path | None], files: Files) -> bool:
    """Whether a frame has all masks that it will have; while its input is followed every camera must have one."""
    there = [path for path in masks if path is not None]
    return len(files.complete(there)) == len(there) and (files.settling is None or len(there) == len(masks))


def _packed_silhouettes(paths: Sequence[Path], files: Files) -> list[Source]:
    """A frame for every npz that holds the masks of all cameras."""
    calibrated, calibration, contents = _calibrated(paths[0].parent, files)
    stated = {"kind": "silhouettes", "calibration": calibrated, "fps": calibration.fps, "unit": calibration.unit}
    named = zip(paths, files.digests(paths, MOST_MASK_BYTES), strict=True)
    return [Source(content=digest(["silhouettes", contents, [c]]), path=str(p), masks=(str(p),), **stated) for p, c in named]


def _calibrated(folder: Path, files: Files) -> tuple[tuple[str, ...], Calibration, list[str]]:
    """The calibration of a folder: its files, what they hold, and their digests; raises SourceError where there is none."""
    calibrated = calibration_files(folder)
    if not calibrated:
        raise SourceError(f"{folder}: silhouettes without a calibration of their cameras; put {' or '.join(NAMES[:3])} there")
    return tuple(map(str, calibrated)), read_calibration(calibrated), files.digests(calibrated)


def _packed_volumes(path: Path, files: Files) -> list[Source]:
    """Every frame of one array of volumes."""

    def parts(where: Path) -> Sequence[str]:
        frames = volumes(where)
        return [grid_digest(frames.grid(t)) for t in range(len(frames))]

    contents = files.parts(path, "volumes/1", parts)
    return [Source(content=c, path=str(path), part=t, kind="volume") for t, c in enumerate(contents)]


def _is_zarr(path: Path) -> bool:
    with _refusals(path):
        return any((path / name).is_file() for name in ("zarr.json", ".zgroup", ".zarray"))


@contextlib.contextmanager
def _refusals(path: Path) -> Iterator[None]:
    """Turns what the file system refuses of a path into an error that a user can act on."""
    try:
        yield
    except OSError as error:
        raise SourceError(f"{path}: cannot be read: {error.strerror}; check its name and its permissions") from None
