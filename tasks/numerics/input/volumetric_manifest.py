"""The manifest of a Universal Volumetric 2 sequence: which files are its frames, and how many frames a second.

Source: Universal Volumetric, src/Interfaces.ts: GeometryTarget and V2Schema, also as `output` of an encoder's configuration;
`[target]`, `[index]` or a row of `#`, and `[ext]` stand in its path. A target of the format `uniform-solve` has one GLB for
every few frames, whose morph targets are the frames.
"""

import glob
import re
from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path, PurePosixPath
from typing import Any, Literal, NamedTuple

from kinetree.errors import SourceError
from kinetree.errors.small_text import small_json, small_text
from kinetree.tasks.numerics.input.foreign import VOLUMETRIC_1
from kinetree.tasks.numerics.input.frame_numbers import TAKE

SUFFIXES = (".json", ".manifest")
LARGEST = 2**26
"""Bytes of a manifest, and of the JSON files of a folder that are looked through for one; version 1 lists every frame in it."""
_WORDS = ("geometry", "DRCURLPattern", "frameData")
"""Every manifest has one of them."""
_INDEX = re.compile(r"\[index\]|\[#+\]|#+")
_EXTENSIONS: Mapping[str, tuple[Literal["file", "segment"], str]] = {
    "draco": ("file", ".drc"), "obj": ("file", ".obj"), "glb": ("file", ".glb"), "gltf": ("file", ".glb"),
    "uniform-solve": ("segment", ".glb"),
}  # fmt: skip
"""Whether a file of each format is a frame or some of them, and how it ends."""


class VolumetricManifest(NamedTuple):
    """The files of one target.

    numbers : of each file, from its name; files lie in their order
    holds   : file where each is a frame; segment where each is a GLB whose morph targets are frames
    length  : frames of a segment; 1 where a file is a frame
    fps     : frames a second; None where the manifest does not say
    """

    files: tuple[Path, ...]
    numbers: tuple[int, ...]
    holds: Literal["file", "segment"]
    length: int
    fps: float | None


def manifest_in(folder: Path, *, beside_meshes: bool = False) -> Path | None:
    """The one manifest of a folder; None where there is none.

    beside_meshes : the folder can be read without one: then an encoder's configuration, or a manifest of version 1, is none
    raises        : SourceError where there are several
    """
    files = [(path.stat().st_size, path) for path in folder.iterdir() if path.suffix.lower() in SUFFIXES and path.is_file()]
    manifests, read = [], 0
    for size, path in sorted(files):  # a manifest is small; a take may have a large file for every frame
        read += size
        if read > LARGEST:
            break
        document = _document_or_none(path)
        if _is_manifest(document) and not (beside_meshes and (_is_version_1(document) or "output" in document)):
            manifests.append(path)
    if len(manifests) > 1:
        names = " and ".join(path.name for path in sorted(manifests)[:3])
        raise SourceError(f"{folder}: {names} are manifests; name one of them")
    return manifests[0] if manifests else None


def read_manifest(path: Path, target: str = "", *, is_growing: bool = False) -> VolumetricManifest:
    """The files of a target that a manifest names, all of which lie in its folder.

    target     : its name; where empty, that with the most frames a second, of those the most bits of a position
    is_growing : fewer or more files than the manifest has frames are no fault
    raises     : SourceError where it is no manifest of version 2, or files are not there
    """
    manifest = _document(path)
    if not _is_manifest(manifest):
        raise SourceError(f"{path}: no manifest of Universal Volumetric 2: it has no geometry; name the folder of the frames")
    if _is_version_1(manifest):
        raise SourceError(f"{path}: {VOLUMETRIC_1}")
    name, template, chosen = _target(manifest, target, path)
    holds, ending = _EXTENSIONS.get(str(chosen.get("format", "draco")).lower(), ("file", ""))
    if not ending:
        raise SourceError(f"{path}: {name or 'its geometry'} is {chosen['format']!r}; {', '.join(_EXTENSIONS)} are read")
    file_of = _files(path, template, name, ending)
    length = _count(chosen, "segmentFrameCount", path) if holds == "segment" else 1
    if length is None:
        raise SourceError(f"{path}: {name} has no segmentFrameCount, the frames of one file; the manifest is not complete")
    if (max(file_of) + 1) * length > TAKE:
        raise SourceError(f"{path}: frame {max(file_of) * length} is beyond the last number that a frame may have, {TAKE - 1}")
    claimed = _count(chosen, "frameCount", path)
    if claimed is not None and not is_growing:
        _refuse_other_count(path, name, claimed, list(file_of.values()), length)
    return VolumetricManifest(tuple(file_of.values()), tuple(file_of), holds, length, _rate(chosen, path))


def _document(path: Path) -> Any:
    return small_json(small_text(path, SourceError, LARGEST), str(path), SourceError)


def _document_or_none(path: Path) -> Any:
    """What a file beside others holds; None where that cannot be read, since it need not be a manifest."""
    try:
        text = small_text(path, SourceError, LARGEST)
        return small_json(text, str(path), SourceError) if any(word in text for word in _WORDS) else None
    except SourceError:
        return None


def _is_manifest(document: Any) -> bool:
    """Whether a JSON value has what only manifests have, of either version."""
    if not isinstance(document, dict):
        return False
    geometry = _mapping(document, "geometry") or _mapping(_mapping(document, "output"), "geometry")
    return bool({"targets", "path", "frameData"} & set(geometry)) or "DRCURLPattern" in document or "frameData" in document


def _is_version_1(manifest: Mapping[str, Any]) -> bool:
    """Whether a manifest lists its frames, which lie in one file."""
    return "frameData" in manifest or "frameData" in _mapping(manifest, "geometry")


def _mapping(document: Mapping[str, Any], key: str) -> Mapping[str, Any]:
    """What lies under a key, if it is a mapping."""
    value = document.get(key)
    return value if isinstance(value, dict) else {}


def _target(manifest: Mapping[str, Any], wanted: str, path: Path) -> tuple[str, str, Mapping[str, Any]]:
    """Name, path and description of a target; manifests of the first kind of version 2 have one without a name."""
    if "DRCURLPattern" in manifest:
        early = {"frameRate": manifest.get("GeometryFrameRate"), "frameCount": manifest.get("GeometryFrameCount")}
        return "", str(manifest["DRCURLPattern"]), {key: value for key, value in early.items() if value is not None}
    geometry = _mapping(manifest, "geometry") or _mapping(_mapping(manifest, "output"), "geometry")
    targets = {name: value for name, value in _mapping(geometry, "targets").items() if isinstance(value, dict)}
    template = str(geometry.get("path", ""))
    if not targets and "[target]" not in template:
        return "", template, {}
    if not targets or (wanted and wanted not in targets):
        there = ", ".join(sorted(targets)) or "none"
        raise SourceError(f"{path}: source.clip {wanted}: its targets are {there}" if wanted else f"{path}: it has no targets")
    name = wanted or max(sorted(targets), key=lambda name: _fineness(targets[name], path))
    return name, template, targets[name]


def _fineness(target: Mapping[str, Any], path: Path) -> tuple[float, float]:
    """What the finest of several targets has most of."""
    bits = _mapping(target, "settings").get("positionQuantizationBits", 11)
    return _rate(target, path) or 0.0, float(bits) if isinstance(bits, int | float) else 0.0


def _files(path: Path, template: str, name: str, ending: str) -> dict[int, Path]:
    """The files of a target's name and ending at a template, by number, in the order of numbers."""

    def filled(part: str) -> str:
        return part.replace("[ext]", ending).replace("[target]", name)

    whole = filled(template)
    relative = PurePosixPath(whole)
    if relative.is_absolute() or ".." in relative.parts or "\\" in whole or "://" in whole:
        raise SourceError(f"{path}: its frames lie at {whole!r}, outside its folder; put them beside it and name their folder")
    places = list(_INDEX.finditer(template))  # not in the name of the target, which may have the same signs
    if len(places) != 1:
        raise SourceError(f"{path}: {whole!r} is no path of frames; one [index] must stand for their numbers")
    before, after = filled(template[: places[0].start()]), filled(template[places[0].end() :])
    number = re.compile(re.escape(before) + "([0-9]+)" + re.escape(after))
    try:
        there = list(path.parent.glob(f"{glob.escape(before)}*{glob.escape(after)}"))
    except (OSError, RecursionError) as error:  # names too long, folders in folders without end
        raise SourceError(f"{path}: {whole[:80]!r} is no path of frames ({type(error).__name__})") from None
    named = ((number.fullmatch(file.relative_to(path.parent).as_posix()), file) for file in there)
    numbered = sorted((int(match[1]), file) for match, file in named if match)
    if not numbered:
        raise SourceError(
            f"{path}: no file at {before}0000000{after}; copy the frames beside the manifest, or name their folder"
            " or a pattern (*.ply)"
        )
    if twice := {file for (n, _), (m, file) in pairwise(numbered) if n == m}:
        raise SourceError(f"{path}: {min(twice).name} has the number of another file; take one of them away")
    return dict(numbered)


def _refuse_other_count(path: Path, name: str, claimed: int, files: Sequence[Path], length: int) -> None:
    """Raises SourceError where files of this many frames each are not as many as the manifest claims frames."""
    claim = f"{path}: {name or 'its geometry'} has {claimed} frames, but"
    if len(files) > -(-claimed // length):
        raise SourceError(f"{claim} {len(files)} files are there; take the others away")
    if len(files) * length < claimed:
        folder = files[0].parent
        alone = f"{folder}/*{files[0].suffix}" if folder == path.parent else f"their folder {folder}"
        remedy = "copy the others too" + (f", or name {alone}" if length == 1 else "")
        raise SourceError(f"{claim} only {len(files) * length} are there, in {len(files)} files; {remedy}")


def _rate(target: Mapping[str, Any], path: Path) -> float | None:
    """Frames a second, a positive number."""
    rate = target.get("frameRate")
    if rate is None:
        return None
    if not isinstance(rate, int | float) or isinstance(rate, bool) or not 0 < rate < float("inf"):
        raise SourceError(f"{path}: frameRate is {str(rate)[:40]}; a positive number of frames a second is needed")
    return float(rate)


def _count(target: Mapping[str, Any], key: str, path: Path) -> int | None:
    """A positive whole number."""
    count = target.get(key)
    if count is None:
        return None
    if not isinstance(count, int) or isinstance(count, bool) or count < 1:
        raise SourceError(f"{path}: {key} is {str(count)[:40]}; a positive whole number is needed")
    return count
