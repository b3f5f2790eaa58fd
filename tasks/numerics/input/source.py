"""Sequences of meshes: which files are frames, in which order, and what one frame holds.

A file is input from outside: every count it claims is held against its size before memory is taken, nothing outside it
is opened, and whatever cannot be a mesh is refused with its name and the reason.
"""

import glob
import re
from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from functools import lru_cache
from pathlib import Path, PurePath
from typing import Any, TypeVar

import numpy as np

from kinetree.errors import SourceError
from kinetree.tasks.numerics.arrays import Faces, Floats, Ints
from kinetree.tasks.numerics.input.foreign import advice
from kinetree.tasks.numerics.input.formats import checked, suffixes
from kinetree.tasks.numerics.input.npz import npz_arrays

_PACKED = [".gz", ".bz2", ".xz", ".zst", ".lz4", ".zip"]
"""Suffixes of files that must be unpacked before they can be read."""
_WHOLE = {
    *suffixes(),
    ".zip",
    ".usd",
    ".usda",
    ".usdc",
    ".usdz",
    ".npz",
    ".npy",
    ".nrrd",
    ".tif",
    ".tiff",
    ".yaml",
    ".json",
    ".manifest",
}
"""Suffixes that only files have."""
AnyPath = TypeVar("AnyPath", bound=PurePath)
ARRAYS = "vertices", "faces", "vertex_offsets", "face_offsets", "fps", "unit"


def natural_order(name: str) -> tuple[tuple[str | int, ...], str]:
    """Sort key by which frame_2 comes before frame_10; names that differ in zeros or case alone keep a fixed order.

    returns : text and numbers in turn (so that like is compared with like), then the name itself
    """
    parts = re.split(r"([0-9]+)", name)
    return tuple(int(part) if i % 2 else part.casefold() for i, part in enumerate(parts)), name


def mesh_files(where: Path | str) -> list[Path]:
    """The mesh files of a folder or of a glob pattern, one a frame, in natural order.

    Other files (textures, truth.json) and hidden ones are passed over.

    raises : SourceError if there is nothing of the name, no mesh in it, meshes of several formats, or what is no file
             under the name of a mesh
    """
    path = Path(where).expanduser()
    if path.is_dir():
        files = regular([p for p in path.iterdir() if not p.name.startswith(".")], suffixes())
        pattern = ""
    elif glob.has_magic(str(path)):
        # Path.glob takes no absolute pattern
        files = regular([Path(p) for p in glob.glob(str(path), recursive=True)], suffixes())  # noqa: PTH207
        pattern = "matches of "
    else:
        raise SourceError(_not_a_folder(path))
    return one_format(files, f"{pattern}{path}", path if path.is_dir() else None)


def one_format(files: Sequence[AnyPath], where: str, folder: Path | None = None) -> list[AnyPath]:
    """The meshes among files, in natural order.

    where  : what messages call the place of the files
    folder : which they all lie in, if they do
    raises : SourceError if there is no mesh among them, or meshes are of several formats
    """
    kinds = Counter(p.suffix.lower() for p in files)
    meshes = {kind: n for kind, n in sorted(kinds.items()) if kind in suffixes()}
    _refuse_packed(files, where)
    if not meshes:
        others = ", ".join(f"{n} × {kind or 'no suffix'}" for kind, n in sorted(kinds.items())) or "nothing"
        known = " ".join(suffixes())
        hint = advice(set(kinds))
        raise SourceError(f"{where}: no mesh among its files ({others}); {known} are read, one file a frame{hint}")
    if len(meshes) > 1:
        counts = ", ".join(f"{n} × {kind}" for kind, n in meshes.items())
        likely = max(meshes, key=lambda kind: meshes[kind])
        example = f"*{likely}" if folder is None else folder / f"*{likely}"
        raise SourceError(f"{where}: meshes of several formats ({counts}); choose by a pattern such as {example}")
    return sorted((p for p in files if p.suffix.lower() in meshes), key=lambda p: [natural_order(q) for q in p.parts])


def _refuse_packed(files: Sequence[PurePath], where: str) -> None:
    """Refuses packed meshes that do not lie there unpacked as well: leaving one out would be a frame that vanishes."""
    there = {p.name for p in files}
    packed = sorted(p.name for p in files if p.suffix.lower() in _PACKED and p.stem not in there)
    packed = [name for name in packed if PurePath(name).with_suffix("").suffix.lower() in suffixes()]
    if packed:
        more = f" (and {len(packed) - 1} more)" if len(packed) > 1 else ""
        raise SourceError(f"{where}: {packed[0]}{more} is packed; unpack it first, for instance with gunzip or unzip")


@dataclass(frozen=True)
class Frames:
    """A sequence in a few arrays, all frames one after the other; reads only the frame asked for.

    fps  : frames a second, None if not known
    unit : of the coordinates, None if not known
    """

    fps: float | None
    unit: str | None
    name: str
    _arrays: Mapping[str, Any]
    _vertex_offsets: Ints
    _face_offsets: Ints

    @classmethod
    def of(cls, arrays: Mapping[str, Any], name: str) -> "Frames":
        """Frames from arrays by name: numpy's, or any that have a shape and a dtype and can be sliced.

        vertices, faces : (all vertices, xyz) · (all faces, corner), indices counted within the frame
        vertex_offsets  : (frame + 1,) where each frame's vertices begin, and their end
        face_offsets    : likewise, or (2,) if all frames have the same faces
        fps, unit       : (), may be missing
        raises          : SourceError if an array is missing, or of a shape, type or order that cannot be
        """
        if missing := [key for key in ARRAYS[:4] if key not in arrays]:
            raise SourceError(f"{name}: no array {', '.join(missing)}; there are {', '.join(sorted(arrays)) or 'none'}")
        for key, kind, what in (("vertices", "f", "floating"), ("faces", "iu", "whole")):
            array = arrays[key]
            if array.dtype.kind not in kind or len(array.shape) != 2 or array.shape[1] != 3:
                raise SourceError(f"{name}: {key} is {array.dtype} {tuple(array.shape)}; {what} numbers (n, 3) are needed")
        vertex_offsets = _offsets(arrays, "vertex_offsets", "vertices", name)
        face_offsets = _offsets(arrays, "face_offsets", "faces", name)
        frames = len(vertex_offsets) - 1
        if len(face_offsets) not in (2, frames + 1):
            raise SourceError(
                f"{name}: vertex_offsets are of {frames} frames, face_offsets of {len(face_offsets) - 1}; "
                "they must agree, or face_offsets hold one pair for all frames"
            )
        if len(face_offsets) == 2 and len(set(np.diff(vertex_offsets))) > 1:
            raise SourceError(f"{name}: one set of faces for all frames, but frames differ in their number of vertices")
        return cls(_rate(arrays, name), _unit(arrays), name, arrays, vertex_offsets, face_offsets)

    def __len__(self) -> int:
        return len(self._vertex_offsets) - 1

    def mesh(self, t: int) -> tuple[Floats, Faces]:
        """V (vertex, xyz) and F (face, corner) of frame t, which the caller may change; MeshError as `checked`."""
        if not 0 <= t < len(self):
            raise SourceError(f"{self.name}: there is no frame {t}; frames are 0 to {len(self) - 1}")
        i = t if len(self._face_offsets) > 2 else 0
        V = self._arrays["vertices"][self._vertex_offsets[t] : self._vertex_offsets[t + 1]]
        F = self._arrays["faces"][self._face_offsets[i] : self._face_offsets[i + 1]]
        return checked(np.array(V, dtype=np.float64), np.array(F), f"{self.name}, frame {t}")


def read_npz(path: Path | str) -> Frames:
    """All frames of one .npz; asked again for the same unchanged file, the same value without reading.

    raises : SourceError if it is no .npz of plain arrays, or as `Frames.of`
    """
    path = Path(path)
    if not path.is_file():
        raise SourceError(f"{path}: {'not a file' if path.exists() else 'there is no such file'}")
    state = path.stat()
    return _frames(str(path.resolve()), state.st_size, state.st_mtime_ns)


def regular(paths: Iterable[Path], frames: Collection[str]) -> list[Path]:
    """The files among paths; what is none is passed over.

    frames : suffixes of frames, in lower case
    raises : SourceError where what has such a suffix is no file: leaving it out would be a frame that vanishes
    """
    there = list(paths)
    files = [path for path in there if path.is_file()]
    lost = sorted(path for path in set(there) - set(files) if path.suffix.lower() in frames)
    if lost:
        more = f" (and {len(lost) - 1} more)" if len(lost) > 1 else ""
        raise SourceError(f"{lost[0]}{more}: {_not_a_file(lost[0])}; put the frame's file there, or take the name away")
    return files


def written(path: Path) -> Path:
    """The path, if its name can be written down; raises SourceError where its bytes are no text."""
    try:
        str(path).encode()
    except UnicodeEncodeError:
        raise SourceError(f"{str(path)!r}: this name is not valid UTF-8; rename the file or folder") from None
    return path


def refuse_unreadable(path: Path) -> None:
    """A file that may not be read is not a damaged one."""
    try:
        path.open("rb").close()
    except FileNotFoundError:
        return
    except OSError as error:
        raise SourceError(f"{path}: cannot be read: {error.strerror}; check its permissions") from None


@lru_cache(maxsize=2)
def _frames(path: str, size: int, mtime_ns: int) -> Frames:
    """The file in this state; two are remembered, so that reading frame after frame unpacks it once."""
    try:
        arrays = npz_arrays(Path(path), ARRAYS, SourceError)
    except SourceError:
        raise
    except Exception as error:
        raise SourceError(
            f"{path}: cannot be read as .npz ({type(error).__name__}: {error}); an archive of plain arrays is needed"
        ) from error
    for array in arrays.values():
        array.flags.writeable = False
    return Frames.of(arrays, path)


def _offsets(arrays: Mapping[str, Any], key: str, of: str, name: str) -> Ints:
    """The offsets `key` into the array `of`, each frame holding at least one element."""
    if arrays[key].dtype.kind not in "iu" or len(arrays[key].shape) != 1 or arrays[key].shape[0] < 2:
        layout = f"{arrays[key].dtype} {tuple(arrays[key].shape)}"
        raise SourceError(f"{name}: {key} is {layout}; whole numbers (frame + 1,) are needed")
    offsets = np.asarray(arrays[key][...]).astype(np.int64)
    if (np.diff(offsets) <= 0).any():
        t = int(np.flatnonzero(np.diff(offsets) <= 0)[0])
        raise SourceError(f"{name}: {key} must increase, but {offsets[t + 1]} follows {offsets[t]} after frame {t}")
    if offsets[0] < 0 or offsets[-1] > arrays[of].shape[0]:
        rows = arrays[of].shape[0]
        raise SourceError(f"{name}: {key} run from {offsets[0]} to {offsets[-1]}, but there are {rows} {of}")
    return offsets


def _rate(arrays: Mapping[str, Any], name: str) -> float | None:
    """Frames a second as the file states them."""
    if "fps" not in arrays:
        return None
    fps = np.asarray(arrays["fps"][...])
    if fps.dtype.kind not in "fiu" or fps.size != 1 or not 0 < float(fps.reshape(())) < np.inf:
        raise SourceError(f"{name}: fps is {fps}; one positive number of frames a second is needed, or none")
    return float(fps.reshape(()))


def _unit(arrays: Mapping[str, Any]) -> str | None:
    """Unit of length as the file states it."""
    unit = np.asarray(arrays["unit"][...]).reshape(-1) if "unit" in arrays else np.empty(0)
    word = unit[0] if len(unit) else ""
    text = (word.decode("utf-8", "replace") if isinstance(word, bytes) else str(word)).strip()
    return None if text in ("", "unknown") else text


def _not_a_file(path: Path) -> str:
    """What lies under the name of a frame and is no file."""
    if path.is_symlink() and not path.exists():
        return f"a link to {path.readlink()}, which is not there"
    return "a folder under the name of a frame" if path.is_dir() else "neither a file nor a folder (a pipe, socket or device)"


def _not_a_folder(path: Path) -> str:
    """What to say about a path that is neither a folder nor a pattern: the nearest that exists, and likely names."""
    if path.exists():
        if advised := advice({path.suffix}):
            return f"{path}{advised}"
        return f"{path}: one file, not a sequence; give the folder of the frames' files, or a pattern such as *{path.suffix}"
    missing = path.absolute()
    while not missing.parent.is_dir():
        missing = missing.parent
    like = get_close_matches(missing.name, sorted(p.name for p in missing.parent.iterdir()), n=1)
    hint = f"; there is {missing.parent / like[0]}" if like else f"; the nearest folder that exists is {missing.parent}"
    return f"{path}: there is no such {'file' if path.suffix.lower() in _WHOLE or advice({path.suffix}) else 'folder'}{hint}"
