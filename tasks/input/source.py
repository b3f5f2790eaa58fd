"""Where the frames are: meshes, silhouettes or volumes, a file each or in one file that holds all, or a synthetic body."""

import json
import os
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path, PurePath, PurePosixPath

import numpy as np

from kinetree.errors import MeshError, SourceError, StoreError
from kinetree.pipeline.identity.key import array_digest, digest, file_digest
from kinetree.pipeline.storage.files import Files
from kinetree.pipeline.storage.groups import is_array, opened_array, user_arrays
from kinetree.pipeline.task import origin
from kinetree.schemas.array import Bools as Flags
from kinetree.schemas.array import Floats, Ints
from kinetree.schemas.input.source import BadFrame, Kind, Source, SourceParams
from kinetree.tasks.input.synth import body, recipe
from kinetree.tasks.numerics.input.animated import SUFFIXES as ANIMATED
from kinetree.tasks.numerics.input.animated import Animated, read_animated
from kinetree.tasks.numerics.input.bad_frames import (
    FrameMeasures,
    bad_frames,
    frame_measures,
    frames_of_other_bodies,
    refuse_bad,
    refuse_other_bodies,
)
from kinetree.tasks.numerics.input.calibration import NAMES, Calibration, calibration_files, read_calibration
from kinetree.tasks.numerics.input.formats import read_mesh
from kinetree.tasks.numerics.input.formats import suffixes as mesh_suffixes
from kinetree.tasks.numerics.input.frame_numbers import TAKE, are_frame_numbers, frame_numbers, selected_frames
from kinetree.tasks.numerics.input.input_kind import input_kind
from kinetree.tasks.numerics.input.silhouettes import mask_files, read_masks, read_packed_masks
from kinetree.tasks.numerics.input.source import (
    ARRAYS,
    Frames,
    mesh_files,
    one_format,
    read_npz,
    refuse_unreadable,
    written,
)
from kinetree.tasks.numerics.input.volumes import Grid, Volumes, read_volume, read_volumes
from kinetree.tasks.numerics.input.zipped import Zipped

REMOTE = "content and measures/2"
"""How the memory of files calls what is read of a mesh in a bucket."""


@origin(over="frame")
def source(params: SourceParams, files: Files) -> Mapping[int, Source]:
    """Finds the frames of a sequence and the digest of each one's bytes (2014, Sec. 3)."""
    if params.takes:
        return _several(params, files)
    if params.synth is not None:
        if params.input:
            raise SourceError(f"source.input ({params.input}) and source.synth exclude each other; leave one out")
        return _chosen(_generated(recipe(params.synth), params.synth.frames), params.frames, "the synthetic sequence")
    if not params.input:
        raise SourceError("no input: name a folder of meshes with --input, or source.input in the config")
    return _usable(_chosen(_found(params.input, files, params.clip), params.frames, params.input), params, files)


def _several(params: SourceParams, files: Files) -> dict[int, Source]:
    """The frames of several takes, numbered one take after the other; bad frames are looked for in each take by itself.

    raises : SourceError where a take shows another body
    """
    if params.input or params.synth is not None:
        raise SourceError("source.takes excludes source.input and source.synth; name each take's input in source.takes")
    names = [take.name for take in params.takes]
    if len(set(names)) < len(names) or not all(take.input for take in params.takes):
        raise SourceError(f"source.takes: {', '.join(names)}: each take needs a name of its own and an input")
    found: dict[int, Source] = {}
    measured: dict[str, list[FrameMeasures]] = {}
    for k, take in enumerate(params.takes):
        own = _usable(_chosen(_found(take.input, files, take.clip), params.frames, take.input), params, files)
        measured[take.name] = [m for m in _measured(own, files).values() if not isinstance(m, str)]
        for t, frame in own.items():
            dropped = tuple(bad.model_copy(update={"frame": k * TAKE + bad.frame}) for bad in frame.dropped)
            found[k * TAKE + t] = frame.model_copy(update={"take": take.name, "dropped": dropped})
    refuse_other_bodies(measured)
    return found


def _usable(sources: Mapping[int, Source], params: SourceParams, files: Files) -> dict[int, Source]:
    """The frames without those that cannot be of the same body as the others; the frame before a dropped one names it.

    raises : SourceError where there are more of them than may be dropped
    """
    measured = _measured(sources, files)
    bad = bad_frames(measured)
    if params.other_body == "drop":
        usable = {t: m for t, m in measured.items() if t not in bad and not isinstance(m, str)}
        bad = dict(sorted((bad | frames_of_other_bodies(usable)).items()))
    refuse_bad(bad, len(sources), params.bad_share if params.on_bad_frame == "drop" else None)
    good = [t for t in sources if t not in bad]
    if bad and len(good) < 2:
        refuse_bad(bad, len(sources), None)
    after: dict[int, list[BadFrame]] = {}
    for t, reason in bad.items():
        before = max((g for g in good if g < t), default=good[0])
        after.setdefault(before, []).append(BadFrame(frame=t, reason=reason))
    return {t: sources[t].model_copy(update={"dropped": tuple(after[t])}) if t in after else sources[t] for t in good}


def _measured(sources: Mapping[int, Source], files: Files) -> dict[int, FrameMeasures | str]:
    """What the surface of every frame is like, or why it cannot be read; nothing where frames are no meshes yet."""
    kinds = {s.kind for s in sources.values()}
    if kinds <= {"npz", "zarr", "animated"}:
        first = next(iter(sources.values()))
        held = files.parts(first.path, _memory(first, "measures/2"), lambda where: _measures_of_parts(where, first))
        return {t: _parsed(held[s.part or 0]) for t, s in sources.items()}
    if kinds == {"file"}:
        return {t: _parsed(_measures(s.path, files)) for t, s in sources.items()}
    return {}


def _measures(path: str, files: Files) -> str:
    """The measures of one mesh file, or why it cannot be read, as JSON."""
    if files.is_remote(path):
        return files.parts(path, REMOTE, _content_and_measures)[1]
    return files.parts(Path(path), "measures/2", _measures_of_file)[0]


def _content_and_measures(path: Path) -> Sequence[str]:
    """Digest and measures of a copy of a mesh file, which is made once for both."""
    return [file_digest(path), *_measures_of_file(path)]


def _measures_of_file(path: Path) -> Sequence[str]:
    """The measures of a mesh file as JSON, or why it cannot be read."""
    try:
        refuse_unreadable(path)
        return [json.dumps(frame_measures(*read_mesh(path)))]
    except (MeshError, SourceError) as error:
        return [json.dumps(str(error).replace(f"{path.parent}{os.sep}", ""))]


def _measures_of_parts(path: Path, of: Source) -> Sequence[str]:
    """The measures of all frames of one file, or why one cannot be read, as JSON."""
    frames = _packed_frames(path, of.kind, of.clip)
    return [json.dumps(_measures_of_part(frames, t, path)) for t in range(len(frames))]


def _measures_of_part(frames: Animated, t: int, path: Path) -> object:
    try:
        return frame_measures(*frames.mesh(t))
    except (MeshError, SourceError) as error:
        return str(error).replace(f"{path.parent}{os.sep}", "")


def _memory(of: Source, what: str) -> str:
    """How the memory of files calls what is read of all frames of one file."""
    return f"{of.kind}{f'={of.clip}' if of.clip else ''}/{what}"


def _parsed(text: str) -> FrameMeasures | str:
    """Measures, or the reason why there are none, from JSON."""
    held = json.loads(text)
    if isinstance(held, str):
        return held
    area, size, (x, y, z), vertices, pieces, volume = held
    return FrameMeasures(area, size, (x, y, z), vertices, pieces, volume)


def _found(where: str, files: Files, clip: str = "") -> dict[int, Source]:
    """Every frame at a path, a pattern or in a packed sequence, by number."""
    if files.is_remote(where):
        return _in_bucket(where, files, clip)
    if "://" in where:
        raise SourceError(f"{where.partition('://')[0]}:// is not read; give a folder, a pattern, a file or s3://bucket/folder")
    path = written(Path(where))
    if path.suffix.lower() in ANIMATED and path.is_file():
        return _animated(path, clip, files)
    if clip:
        raise SourceError(f"source.clip {clip}: names an animation of one GLB, and {where} is none; leave it out")
    if _is_zarr(path):
        return dict(enumerate(_packed_volumes(path, files) if is_array(path) else _packed(path, "zarr", files)))
    kind, found = input_kind(where)
    if kind == "silhouettes":
        return _silhouettes(path, files)
    if kind == "packed silhouettes":
        found = _complete([written(p) for p in found], where, files)
        return _numbered(_packed_silhouettes(found, files), found)
    if kind == "packed volumes" or (kind == "meshes" and path.suffix == ".npz"):
        return dict(enumerate(_packed_volumes(path, files) if kind == "packed volumes" else _packed(path, "npz", files)))
    paths = _complete([written(p) for p in (found if kind == "volumes" else mesh_files(where))], where, files)
    form: Kind = "volume" if kind == "volumes" else "file"
    contents = files.digests(paths)
    return _numbered([Source(content=c, path=str(p), kind=form) for c, p in zip(contents, paths, strict=True)], paths)


def _animated(path: Path | str, clip: str, files: Files) -> dict[int, Source]:
    """Every frame of one file that holds a moving surface; a zip's have the numbers of their names."""
    sources = _packed(path, "animated", files, clip)
    if PurePath(path).suffix.lower() != ".zip":
        return dict(enumerate(sources))
    names = files.parts(path, "names/1", lambda where: [str(name) for name in Zipped(where).names])
    return _numbered(sources, [PurePosixPath(name) for name in names])


def _in_bucket(where: str, files: Files, clip: str) -> dict[int, Source]:
    """Every frame of a folder or pattern of mesh files in a bucket, or of one file there that holds all."""
    addresses = files.found(where)
    named = {PurePosixPath(address.partition("://")[2]): address for address in addresses}
    suffixes = {path.suffix.lower() for path in named}
    if suffixes == {".npz"} and len(addresses) == 1:
        return dict(enumerate(_packed(addresses[0], "npz", files)))
    if len(addresses) == 1 and suffixes <= set(ANIMATED):
        return _animated(addresses[0], clip, files)
    if not suffixes & set(mesh_suffixes()):
        raise SourceError(
            f"{where}: no mesh among its files ({', '.join(sorted(suffixes))}); in a bucket a folder or pattern of mesh files"
            f" ({' '.join(mesh_suffixes())}) or one npz is read; silhouettes, volumes and zarr are read from folders"
        )
    paths = one_format(list(named), where)
    told = files.parts_of_each([named[path] for path in paths], REMOTE, _content_and_measures)
    sources = [Source(content=content, path=named[path]) for path, (content, _) in zip(paths, told, strict=True)]
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


def _generated(written: str, frames: int) -> dict[int, Source]:
    """Every frame of a synthetic sequence."""
    generated = body(written)
    unit, fps = generated.figure.unit, generated.fps
    stated = {"path": "synth", "kind": "synth", "recipe": written, "fps": fps, "unit": unit}
    return {t: Source(content=digest(["synth", written, t]), part=t, **stated) for t in range(frames)}


def _chosen(sources: Mapping[int, Source], frames: str, where: str) -> dict[int, Source]:
    """The frames wanted, by number, each of which knows the first and last number of all."""
    chosen = selected_frames(frames, list(sources), where)
    if len(chosen) < 2:
        held = f"frames {frames!r} selects" if len(sources) > 1 else f"{where}: there is"
        raise SourceError(f"{held} a single frame; kinematics are seen in motion, give at least two frames")
    series = min(sources), max(sources)
    return {frame: sources[frame].model_copy(update={"series": series}) for frame in chosen}


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
        refuse_unreadable(path)
        V, F = read_mesh(path)
        now = file_digest(path)
    else:
        V, F = _packed_frames(path, frame_source.kind, frame_source.clip).mesh(frame_source.part)
        now = _mesh_digest(V, F)
    _refuse_changed(now, frame_source)
    return V, F


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
        grid = _volumes(path).grid(frame_source.part)
        _refuse_changed(_grid_digest(grid), frame_source)
    return grid


def _refuse_changed(now: str, frame_source: Source) -> None:
    if now != frame_source.content:
        raise SourceError(f"{name(frame_source)}: the file changed while the run was under way; run again")


def name(frame_source: Source) -> str:
    """What messages call the frame."""
    file = Path(frame_source.path).name
    return file if frame_source.part is None else f"{file}, frame {frame_source.part}"


def _silhouettes(folder: Path, files: Files) -> dict[int, Source]:
    """Every frame of a folder with a folder of images for every camera."""
    calibrated, calibration, contents = _calibrated(folder, files)
    frames = [(number, masks) for number, masks in mask_files(folder, calibration) if _are_complete(masks, files)]
    if not frames:
        raise SourceError(f"{folder}: no frame is complete yet")
    digests = dict(zip(paths := [written(p) for _, masks in frames for p in masks if p], files.digests(paths), strict=True))
    made = [
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
    return dict(zip(numbers if are_frame_numbers(numbers) else range(len(made)), made, strict=True))


def _are_complete(masks: Sequence[Path | None], files: Files) -> bool:
    """Whether a frame has all masks that it will have; while its input is followed every camera must have one."""
    there = [path for path in masks if path is not None]
    return len(files.complete(there)) == len(there) and (files.settling is None or len(there) == len(masks))


def _packed_silhouettes(found: Sequence[Path], files: Files) -> list[Source]:
    """A frame for every npz that holds the masks of all cameras."""
    calibrated, calibration, contents = _calibrated(found[0].parent, files)
    stated = {"kind": "silhouettes", "calibration": calibrated, "fps": calibration.fps, "unit": calibration.unit}
    named = zip(found, files.digests(found), strict=True)
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
        held = _volumes(where)
        return [_grid_digest(held.grid(t)) for t in range(len(held))]

    contents = files.parts(path, "volumes/1", parts)
    return [Source(content=c, path=str(path), part=t, kind="volume") for t, c in enumerate(contents)]


def _volumes(path: Path) -> Volumes:
    """The volumes of one npy, npz or zarr array."""
    if not is_array(path):
        return read_volumes(path)
    try:
        return Volumes.of(*opened_array(path), str(path))
    except StoreError as error:  # the user's file, not the store
        raise SourceError(str(error)) from error


def _grid_digest(grid: Grid) -> str:
    """Digest of one frame of packed volumes."""
    return digest(["volume", array_digest(np.ascontiguousarray(grid.values)), grid.origin.tolist(), grid.spacing.tolist()])


def _packed_frames(path: Path, kind: str, clip: str = "") -> Animated:
    """The frames of one file that holds all."""
    if kind == "animated":
        return read_animated(path, clip)
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


def _mesh_digest(V: Floats, F: Ints) -> str:
    """Digest of one frame of a packed sequence."""
    return digest([array_digest(V), array_digest(F)])


def _part_digest(frames: Animated, t: int) -> str:
    """Digest of one frame; "unreadable: …" for one that cannot be read, so that its node can say so."""
    try:
        return _mesh_digest(*frames.mesh(t))
    except (MeshError, SourceError) as error:
        return f"unreadable: {error}"


def _packed(path: Path | str, kind: Kind, files: Files, clip: str = "") -> list[Source]:
    """Every frame of one file that holds all, also of one in a bucket."""
    if isinstance(path, Path) and not path.exists():
        raise SourceError(f"{path}: there is no such file")

    def parts(where: Path) -> Sequence[str]:
        frames = _packed_frames(where, kind, clip)
        heads = [json.dumps(frames.fps), json.dumps(frames.unit)]
        return heads + [_part_digest(frames, t) for t in range(len(frames))]

    every = Source(content="", path=str(path), kind=kind, clip=clip)
    fps, unit, *contents = files.parts(path, _memory(every, "2"), parts)
    stated = {"fps": json.loads(fps), "unit": json.loads(unit)}
    return [every.model_copy(update={"content": c, "part": t, **stated}) for t, c in enumerate(contents)]


def _is_zarr(path: Path) -> bool:
    try:
        return any((path / name).is_file() for name in ("zarr.json", ".zgroup", ".zarray"))
    except OSError as error:
        raise SourceError(f"{path}: cannot be read: {error.strerror}; check its name and its permissions") from None
