"""Zarr groups, ours and the user's: what is written, and what of a group from elsewhere is decoded at all.

A stored group may have been altered, a user's may have been made to do harm. Metadata is therefore read as JSON and compared
with what it may be before zarr sees it: format 3, numbers of fixed width, chunks no larger than their array, codecs that turn
bytes into numbers and nothing else. No chunk is unpacked that says it is larger than its array's metadata says.
"""

import json
import math
import zlib
from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kinetree.errors import StoreError
from kinetree.schemas.array import Array

CHUNK_BYTES = 64 * 2**20
UNPACKED_BYTES = 256 * 2**20
"""An array of more bytes than this …"""
UNPACKED_RATIO = 100
"""… may not be more than this many times what is stored of it."""
ZSTD_RATIO = 2**15
"""No zstd frame unpacks to more than this many times its size: a block of four bytes repeats one byte 128 Ki times."""
NUMBERS = frozenset(
    ["bool", *(f"{kind}{bits}" for kind in ("int", "uint") for bits in (8, 16, 32, 64)), "float16", "float32", "float64"]
)
COMPRESSORS = ("zstd", "gzip", "blosc")
CODECS = frozenset(["bytes", "transpose", "crc32c", *COMPRESSORS])
_SLACK = 64
"""Bytes that a checksum before compression adds to a chunk."""
_META = "zarr.json"
_WRITTEN = ["bytes", "zstd"]
_KEYS = {"name": "default", "configuration": {"separator": "/"}}
"""Codecs and names of chunks as `group_files` has them."""
_HEAD_BYTES = 32


class ForeignArrayError(Exception):
    """An array is not one that may be decoded; says why."""


def group_files(
    attributes: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]], specs: Mapping[str, Array]
) -> dict[str, bytes]:
    """The files of a zarr v3 group with dimension names and units, made in memory."""
    import zarr
    from zarr.codecs import ZstdCodec
    from zarr.storage import MemoryStore

    memory: dict[str, Any] = {}
    group = zarr.create_group(store=MemoryStore(memory), attributes=dict(attributes))
    for name, array in arrays.items():
        group.create_array(
            name,
            data=array,
            chunks=_chunks(array.shape, array.dtype.itemsize),
            dimension_names=_dimensions(specs[name]),
            attributes={"unit": specs[name].unit},
            compressors=ZstdCodec(level=1),
            config={"write_empty_chunks": True},
        )
    return {name: data.to_bytes() for name, data in memory.items()}


def decoded(files: Mapping[str, bytes], spec: Array | None) -> NDArray[Any]:
    """An array from the files of its own, as `group_files` wrote them.

    spec   : what its schema says of it; None where no schema is known
    raises : ForeignArrayError, where a chunk is missing too; whatever a codec says of altered bytes
    """
    meta = _metadata(files.get(_META))
    _refuse_foreign(meta)
    layout = [meta["data_type"], meta.get("dimension_names"), meta.get("attributes")]
    if spec is not None and layout != [spec.dtype, _dimensions(spec), {"unit": spec.unit}]:
        raise ForeignArrayError("its dtype, dimensions or unit are not those of its schema")
    chunks = {path: data for path, data in files.items() if path != _META}
    _refuse_bomb(meta, sum(map(len, chunks.values())))
    if meta["shape"] and 0 in meta["shape"]:
        return np.zeros(meta["shape"], dtype=meta["data_type"])
    if len(chunks) != math.prod(-(-n // c) for n, c in zip(meta["shape"], _chunk_shape(meta), strict=True)):
        raise ForeignArrayError("a chunk is missing")
    for data in chunks.values():
        _refuse_packed(data, meta, len(data))
    return _unpacked(chunks, meta) if _is_one_chunk(chunks, meta) else _read(files)


def user_arrays(path: Path, names: Collection[str]) -> dict[str, NDArray[Any]]:
    """Arrays of a user's zarr group by name, and its attributes as 0-d arrays; no other array is looked at.

    raises : StoreError where there is no readable group, or an array is none that is decoded
    """
    group = _user_metadata(path, "group")
    attributes = group.get("attributes") or {}
    if not isinstance(attributes, dict):
        raise StoreError(f"{path}: not a readable zarr group: its attributes are no JSON object")
    plain = {n: v for n, v in attributes.items() if n in names and isinstance(v, str | int | float)}
    arrays = {name: np.asarray(value) for name, value in plain.items()}
    for name in names:
        if (path / name / _META).is_file() or (path / name / ".zarray").is_file():
            arrays[name] = _user_array(path, name)
    return arrays


def is_array(path: Path) -> bool:
    """Whether one zarr array, not a group, lies at a path."""
    if (path / ".zarray").is_file():
        return True
    try:
        return _metadata((path / _META).read_bytes()).get("node_type") == "array"
    except (OSError, ForeignArrayError):
        return False


def opened_array(path: Path) -> tuple[Any, dict[str, Any]]:
    """A user's zarr array lying anywhere, to be sliced and not read yet, and its attributes.

    raises : StoreError where it is none that is decoded
    """
    import zarr

    try:
        meta = _user_metadata(path, "array")
        _refuse_foreign(meta)
        chunks = [p for p in path.rglob("*") if p.is_file() and p.name != _META]
        _refuse_bomb(meta, sum(p.stat().st_size for p in chunks))
        for chunk in chunks:
            _refuse_packed(chunk.read_bytes() if "gzip" in _codecs(meta) else _head(chunk), meta, chunk.stat().st_size)
        array = zarr.open_array(path, mode="r", zarr_format=3)
        return array, dict(array.attrs)
    except StoreError:
        raise
    except ForeignArrayError as error:
        raise StoreError(f"{path}: not a readable zarr array: {error}") from None
    except Exception as error:  # zarr and its codecs raise many kinds for one fact
        raise StoreError(f"{path}: not a readable zarr array ({type(error).__name__}: {error})") from error


def _user_array(path: Path, name: str) -> NDArray[Any]:
    try:
        return np.asarray(opened_array(path / name)[0][...])
    except StoreError as error:
        raise StoreError(f"{path}: not a readable zarr group: {str(error).removeprefix(f'{path}/')}") from error
    except Exception as error:  # whatever a codec says of altered bytes
        raise StoreError(f"{path}: not a readable zarr group: {name} ({type(error).__name__}: {error})") from error


def _head(chunk: Path) -> bytes:
    """The first bytes of a chunk, in which a compressor says how much it holds."""
    with chunk.open("rb") as file:
        return file.read(_HEAD_BYTES)


def _user_metadata(path: Path, kind: str) -> dict[str, Any]:
    """The metadata of a group or array of format 3 in a folder."""
    try:
        if not (path / _META).is_file() and any((path / old).is_file() for old in (".zgroup", ".zarray")):
            raise ForeignArrayError("it is of zarr format 2; write it again in format 3 (zarr_format=3)")
        meta = _metadata((path / _META).read_bytes())
        if meta.get("zarr_format") != 3 or meta.get("node_type") != kind:
            raise ForeignArrayError(f"expected a {kind} of zarr format 3, got format {meta.get('zarr_format')!r}")
    except (ForeignArrayError, OSError) as error:
        raise StoreError(f"{path}: not a readable zarr group: {error}") from None
    return meta


def _metadata(data: bytes | None) -> dict[str, Any]:
    try:
        meta = json.loads(data or b"")
    except (ValueError, RecursionError):
        meta = None
    if not isinstance(meta, dict):
        raise ForeignArrayError("its metadata cannot be read")
    return meta


def _refuse_foreign(meta: Mapping[str, Any]) -> None:
    """Lets pass an array of numbers on a regular grid with codecs that are known."""
    if meta.get("zarr_format") != 3 or meta.get("node_type") != "array":
        raise ForeignArrayError("it is no array of zarr format 3")
    if str(meta.get("data_type")) not in NUMBERS:
        raise ForeignArrayError(f"data type {str(meta.get('data_type'))[:40]!r}; numbers of fixed width are read")
    shape, chunks = meta.get("shape"), _chunk_shape(meta)
    if not _are_sizes(shape) or not _are_sizes(chunks) or len(chunks) != len(shape or ()):
        raise ForeignArrayError("its shape or chunks cannot be read")
    if any(not 1 <= c <= max(1, n) for c, n in zip(chunks, shape or (), strict=True)):
        raise ForeignArrayError(f"chunks of {chunks} in an array of {shape}")
    names = _codecs(meta)
    if meta.get("storage_transformers") or not set(names) <= CODECS or sum(name in COMPRESSORS for name in names) > 1:
        raise ForeignArrayError(f"codecs {', '.join(names)}; one of {', '.join(COMPRESSORS)} at most is read, without shards")


def _refuse_bomb(meta: Mapping[str, Any], stored: int) -> None:
    """Refuses what would take much memory though little of it is stored."""
    unpacked = math.prod(meta["shape"]) * np.dtype(meta["data_type"]).itemsize
    if unpacked > UNPACKED_BYTES and unpacked > UNPACKED_RATIO * stored:
        raise ForeignArrayError(f"{stored} bytes would unpack to {unpacked}; expected at most {UNPACKED_RATIO} times as many")


def _refuse_packed(data: bytes, meta: Mapping[str, Any], stored: int) -> None:
    """Refuses a chunk that says it unpacks to more than it can hold.

    data : all of it for gzip, else at least its first 32 bytes; stored : how many there are
    """
    expected = math.prod(_chunk_shape(meta)) * np.dtype(meta["data_type"]).itemsize + _SLACK
    codec = next((name for name in _codecs(meta) if name in COMPRESSORS), None)
    sizes = {"zstd": _zstd_size, "gzip": _gzip_size, "blosc": _blosc_size}
    size = sizes[codec](data, expected, stored) if codec else stored
    if size > expected:
        raise ForeignArrayError(f"a chunk would unpack to {size} bytes, expected {expected - _SLACK}")


def _zstd_size(data: bytes, _: int, stored: int) -> int:
    """Bytes a zstd frame says it holds (RFC 8878, 3.1.1.1); where it does not say, the most it can hold."""
    descriptor = data[4] if len(data) > 4 else 0
    width = (1 if descriptor & 0x20 else 0, 2, 4, 8)[descriptor >> 6]
    if not width:
        return stored * ZSTD_RATIO
    begin = 5 + (0 if descriptor & 0x20 else 1) + (0, 1, 2, 4)[descriptor & 3]
    return int.from_bytes(data[begin : begin + width], "little") + (256 if width == 2 else 0)


def _blosc_size(data: bytes, _: int, stored: int) -> int:
    """Bytes a blosc chunk says it holds: its header, bytes 4 to 8."""
    return int.from_bytes(data[4:8], "little")


def _gzip_size(data: bytes, limit: int, _: int) -> int:
    """Bytes in the first member of a gzip file, counted up to a limit; more members count as too many."""
    stream = zlib.decompressobj(wbits=31)
    size, rest = 0, data
    while rest and not stream.eof and size <= limit:
        size += len(stream.decompress(rest, 2**20))
        rest = stream.unconsumed_tail
    return limit + 1 if len(stream.unused_data) > 4 else size  # a checksum may follow


def _is_one_chunk(chunks: Mapping[str, bytes], meta: Mapping[str, Any]) -> bool:
    """Whether an array lies in one chunk, as `group_files` writes all but the largest."""
    is_whole = list(chunks) == ["/".join(["c", *("0" for _ in meta["shape"])])] and _chunk_shape(meta) == meta["shape"]
    order = (meta["codecs"][0].get("configuration") or {}).get("endian", "little") if _codecs(meta) == _WRITTEN else ""
    return is_whole and order == "little" and meta.get("chunk_key_encoding") == _KEYS


def _unpacked(chunks: Mapping[str, bytes], meta: Mapping[str, Any]) -> NDArray[Any]:
    """The array of one chunk; by way of zarr it takes four times as long, most of it in its loop of events."""
    from numcodecs.zstd import decompress

    dtype = np.dtype(meta["data_type"]).newbyteorder("<")
    data = decompress(next(iter(chunks.values())))
    if len(data) != math.prod(meta["shape"]) * dtype.itemsize:
        raise ForeignArrayError(f"a chunk holds {len(data)} bytes, expected {math.prod(meta['shape']) * dtype.itemsize}")
    array: NDArray[Any] = np.frombuffer(data, dtype).reshape(meta["shape"]).astype(meta["data_type"])
    return array


def _read(files: Mapping[str, bytes]) -> NDArray[Any]:
    import zarr
    from zarr.core.buffer import default_buffer_prototype
    from zarr.storage import MemoryStore

    buffer = default_buffer_prototype().buffer
    memory: dict[str, Any] = {path: buffer.from_bytes(data) for path, data in files.items()}
    return np.asarray(zarr.open_array(store=MemoryStore(memory), mode="r", zarr_format=3)[...])


def _codecs(meta: Mapping[str, Any]) -> list[str]:
    codecs: Iterable[Any] = meta.get("codecs") or ()
    return [str(c.get("name") if isinstance(c, dict) else c)[:40] for c in codecs if isinstance(codecs, list)]


def _chunk_shape(meta: Mapping[str, Any]) -> list[int]:
    grid = meta.get("chunk_grid")
    if not isinstance(grid, dict) or grid.get("name") != "regular" or not isinstance(grid.get("configuration"), dict):
        raise ForeignArrayError("its chunks are on no regular grid")
    shape = grid["configuration"].get("chunk_shape")
    return shape if isinstance(shape, list) else [-1]


def _are_sizes(shape: Any) -> bool:
    return isinstance(shape, list) and all(type(n) is int and 0 <= n < 2**48 for n in shape)


def _dimensions(spec: Array) -> list[str] | None:
    return [dim.name for dim in spec.dims] or None


def _chunks(shape: Sequence[int], itemsize: int) -> tuple[int, ...]:
    """The whole array up to 64 MiB, then slabs of the first dimension."""
    if not shape:
        return ()
    row = itemsize * int(np.prod(shape[1:], dtype=np.int64)) or itemsize
    return (max(1, min(shape[0], CHUNK_BYTES // row)), *(max(1, n) for n in shape[1:]))
