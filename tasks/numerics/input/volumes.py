"""Volumes as files: signed distances, densities or occupied voxels on a grid, one file a frame or one array for all.

    walk/volume_0000.npz   array `field` (x, y, z), `origin` (x, y, z) and `voxel` (one length or three)
    walk/frame_0000.npy    (x, y, z), the unit is the voxel
    walk/frame_0000.nrrd   placed by `space origin` and `space directions` along the axes, or by `spacings`
    walk/frame_0000.tif    a stack of pages (z, y, x), the unit is the voxel
    walk.npz, walk.npy     one array (frame, x, y, z)

Nothing is unpickled, and every size a file claims is held against a bound before memory is taken.
"""

import logging
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import nrrd
import numpy as np
import tifffile

from kinetree.errors import HullError, SourceError
from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.input.npz import npz_arrays, npz_shapes
from kinetree.tasks.numerics.input.unpacked import too_large, unpacks_beyond

SUFFIXES = (".npy", ".npz", ".nrrd", ".tif", ".tiff")
ARRAYS = ("field", "volume", "values")
"""Names under which an npz holds a volume, the first that is there."""
MOST_VOXELS = 1_100_000_000
"""Of one frame: 1,024 along every axis."""
MOST_BYTES = 8 * MOST_VOXELS + 2**20
"""Of one frame as a file: the largest numbers, and a header."""
_PACKED = ("gzip", "gz", "bzip2", "bz2")
"""Encodings of NRRD that are unpacked."""
_MOST_DENSE = 2**31
"""So many bytes may an archive unpack to however few are stored of them: voxels of inside and outside are packed well."""
_MOST_PAGES = 65_536


@dataclass(frozen=True)
class Grid:
    """Numbers on a grid as a file holds them.

    values  : (x, y, z) of any kind
    origin  : (xyz,) place of values[0, 0, 0]
    spacing : (xyz,) between neighbours along each axis
    """

    values: Any
    origin: Floats
    spacing: Floats


def read_volume(path: Path) -> Grid:
    """The volume of one frame in one file.

    raises : HullError if it cannot be read, is not three-dimensional, or has no finite numbers
    """
    read = _READERS.get(path.suffix.lower())
    if read is None:
        raise HullError(f"{path}: {path.suffix or 'no suffix'} is not read as a volume; {' '.join(SUFFIXES)} are")
    try:
        if why := too_large(path, MOST_BYTES):
            raise HullError(f"{path}: {why}; crop the volume to the body")
        values, origin, spacing = read(path)
    except HullError:
        raise
    except Exception as error:
        reason = f"{type(error).__name__}: {error}"
        raise HullError(f"{path}: cannot be read as a volume ({reason}); it is damaged, cut short or something else") from None
    return checked(values, origin, spacing, str(path))


def checked(values: Any, origin: Any, spacing: Any, name: str) -> Grid:
    """The grid, if it is one; raises HullError."""
    values = np.asarray(values)
    if values.ndim != 3 or values.dtype.kind not in "biuf" or min(values.shape) < 2:
        raise HullError(f"{name}: {values.dtype} {values.shape}; numbers (x, y, z) with at least 2 along every axis are needed")
    if values.dtype.kind == "f" and not np.isfinite(values).all():
        raise HullError(f"{name}: {int((~np.isfinite(values)).sum())} values are NaN or infinite")
    at = np.asarray(origin, dtype=np.float64).ravel()
    step = np.broadcast_to(np.asarray(spacing, dtype=np.float64).ravel(), 3) if np.size(spacing) in (1, 3) else np.zeros(3)
    if at.shape != (3,) or not np.isfinite(at).all() or not (np.isfinite(step) & (step > 0)).all():
        raise HullError(f"{name}: origin {origin} and voxel {spacing}; three numbers and one or three lengths are needed")
    return Grid(np.ascontiguousarray(values), at, step.copy())


@dataclass(frozen=True)
class Volumes:
    """A sequence of volumes in one array (frame, x, y, z) that can be sliced; reads only the frame asked for."""

    array: Any
    origin: Floats
    spacing: Floats
    name: str

    @classmethod
    def of(cls, array: Any, placed: Mapping[str, Any], name: str) -> "Volumes":
        """From numpy's array, or any that has a shape and a dtype; `placed` may hold origin and voxel; raises SourceError."""
        if array.dtype.kind not in "biuf" or len(array.shape) != 4:
            raise SourceError(f"{name}: {array.dtype} {tuple(array.shape)}; volumes of all frames are numbers (frame, x, y, z)")
        if int(np.prod([int(n) for n in array.shape[1:]])) > MOST_VOXELS:
            raise SourceError(f"{name}: volumes {tuple(array.shape[1:])} have more than {MOST_VOXELS} voxels")
        return cls(array, np.asarray(placed.get("origin", np.zeros(3))), np.asarray(placed.get("voxel", 1.0)), name)

    def __len__(self) -> int:
        return int(self.array.shape[0])

    def grid(self, t: int) -> Grid:
        """The volume of frame t; raises HullError."""
        return checked(self.array[t], self.origin, self.spacing, f"{self.name}, frame {t}")


def read_volumes(path: Path) -> Volumes:
    """All frames in one npz or npy; npy is mapped, not read.

    raises : SourceError
    """
    try:
        if path.suffix.lower() == ".npy":
            return Volumes.of(np.load(path, mmap_mode="r", allow_pickle=False), {}, str(path))
        arrays = _npz_arrays(path)
    except (SourceError, HullError) as error:
        raise SourceError(str(error)) from None
    except Exception as error:
        raise SourceError(f"{path}: cannot be read as volumes ({type(error).__name__}: {error})") from None
    return Volumes.of(arrays["values"], arrays, str(path))


def _refuse_large(shape: tuple[int, ...], path: Path) -> None:
    if int(np.prod([int(n) for n in shape[-3:]])) > MOST_VOXELS:
        raise HullError(f"{path}: a volume of {tuple(shape)} voxels is larger than {MOST_VOXELS}; crop it to the body")


def _npz_arrays(path: Path) -> dict[str, Any]:
    shapes = npz_shapes(path)
    key = next((name for name in ARRAYS if name in shapes), None)
    if key is None:
        raise HullError(f"{path}: no array {' or '.join(ARRAYS)}; there are {', '.join(sorted(shapes)) or 'none'}")
    _refuse_large(shapes[key], path)
    arrays = npz_arrays(path, (key, "origin", "voxel"), HullError, _MOST_DENSE)
    return {"values": arrays.pop(key), **arrays}


def _npz(path: Path) -> tuple[Any, Any, Any]:
    arrays = _npz_arrays(path)
    return arrays["values"], arrays.get("origin", np.zeros(3)), arrays.get("voxel", 1.0)


def _npy(path: Path) -> tuple[Any, Any, Any]:
    mapped = np.load(path, mmap_mode="r", allow_pickle=False)
    _refuse_large(mapped.shape, path)
    return np.array(mapped), np.zeros(3), 1.0


def _nrrd(path: Path) -> tuple[Any, Any, Any]:
    header = nrrd.read_header(str(path))
    if "data file" in header or "datafile" in header:
        raise HullError(f"{path}: keeps its data in another file, which is not opened; save it as one .nrrd")
    _refuse_large(tuple(int(n) for n in header["sizes"]), path)
    _refuse_packed(path)
    values, header = nrrd.read(str(path), index_order="F")
    if header.get("space directions") is None:
        return values, header.get("space origin", np.zeros(3)), header.get("spacings", 1.0)
    directions = np.asarray(header["space directions"], dtype=np.float64)
    step = np.diag(directions)
    if directions.shape != (3, 3) or np.abs(directions - np.diag(step)).max() > 1e-6 * np.abs(directions).max():
        raise HullError(f"{path}: space directions {directions.tolist()} are not along the axes; resample it along x, y, z")
    origin = np.asarray(header.get("space origin", np.zeros(3)), dtype=np.float64)
    for axis in np.flatnonzero(step < 0):
        values = np.flip(values, int(axis))
        origin[axis] += step[axis] * (values.shape[axis] - 1)
    return np.ascontiguousarray(values), origin, np.abs(step)


def _refuse_packed(path: Path) -> None:
    """Refuses data that unpack to more than the header's sizes need, which pynrrd would do to the end."""
    with path.open("rb") as file:
        header = nrrd.read_header(file)
        if header["encoding"] not in _PACKED:
            return
        need = math.prod(int(n) for n in header["sizes"]) * 8  # bytes of the widest numbers
        if unpacks_beyond(file, header["encoding"], path.stat().st_size, need):
            raise HullError(f"{path}: unpacks to more than {need} bytes, which its sizes do not need; the file is damaged")


def _tiff(path: Path) -> tuple[Any, Any, Any]:
    logging.getLogger("tifffile").setLevel(logging.CRITICAL)  # what is wrong with a file is told once, as a refusal
    with tifffile.TiffFile(path) as file:
        _refuse_circle(file, path)
        _refuse_large(tuple(file.series[0].shape), path)
        _refuse_missing_strips(file.series[0], path)
        pages = file.series[0].asarray()
    return np.ascontiguousarray(pages.transpose()), np.zeros(3), 1.0


def _refuse_circle(file: tifffile.TiffFile, path: Path) -> None:
    """Refuses pages of which one names an earlier one as its next, which tifffile would follow for ever."""
    offsets: set[int] = set()
    for k in range(_MOST_PAGES + 1):
        try:
            offset = file.pages[k].offset
        except IndexError:
            return
        if offset in offsets:
            raise HullError(f"{path}: its pages follow each other in a circle; the file is damaged")
        offsets.add(offset)
    raise HullError(f"{path}: more than {_MOST_PAGES} pages; no volume needs as many")


def _refuse_missing_strips(series: tifffile.TiffPageSeries, path: Path) -> None:
    """Refuses pages that claim more strips or tiles than are listed, each of which tifffile would fill with zeros in turn."""
    for k, page in enumerate(series.pages):
        if page is None:
            continue
        listed, claimed = len(page.dataoffsets), math.prod(page.chunked)
        if listed < claimed:
            raise HullError(f"{path}: page {k} claims {claimed} strips or tiles and lists {listed}; the file is damaged")


_READERS: dict[str, Callable[[Path], tuple[Any, Any, Any]]] = {
    ".npz": _npz,
    ".npy": _npy,
    ".nrrd": _nrrd,
    ".tif": _tiff,
    ".tiff": _tiff,
}
