"""Arrays put together from their chunks as this store writes them: numbers in little-endian order, compressed with zstd.

zarr reads them as well, but hands every chunk to a thread of its own and back, which takes longer than the chunk itself.
"""

import itertools
import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

_ENDIAN = ({"name": "bytes"}, {"name": "bytes", "configuration": {"endian": "little"}})
_KEYS = {"name": "default", "configuration": {"separator": "/"}}


def as_written(meta: Mapping[str, Any], chunks: Mapping[str, bytes]) -> NDArray[Any] | None:
    """The array of some metadata, which were found to be those of an array of numbers on a regular grid, none empty.

    chunks  : by path below the array
    returns : None where it is written in another way than ours
    raises  : ValueError, KeyError, RuntimeError where bytes were altered
    """
    if not _is_ours(meta):
        return None
    from numcodecs.zstd import Zstd

    unpack = Zstd().decode
    shape, chunk = tuple(meta["shape"]), tuple(meta["chunk_grid"]["configuration"]["chunk_shape"])
    dtype = np.dtype(meta["data_type"]).newbyteorder("<")
    whole = np.empty(shape, meta["data_type"])
    for place in itertools.product(*(range(-(-n // c)) for n, c in zip(shape, chunk, strict=True))):
        data = unpack(chunks["/".join(("c", *map(str, place)))])
        if len(data) != math.prod(chunk) * dtype.itemsize:
            raise ValueError(f"a chunk holds {len(data)} bytes")
        spans = [slice(p * c, min(p * c + c, n)) for p, c, n in zip(place, chunk, shape, strict=True)]
        inside = tuple(slice(0, s.stop - s.start) for s in spans)
        whole[tuple(spans)] = np.frombuffer(data, dtype).reshape(chunk)[inside]
    return whole


def _is_ours(meta: Mapping[str, Any]) -> bool:
    first, *rest = meta.get("codecs") or ({},)
    is_packed = [codec.get("name") if isinstance(codec, dict) else codec for codec in rest] == ["zstd"]
    return first in _ENDIAN and is_packed and meta.get("chunk_key_encoding") == _KEYS
