"""Identity: what a value, a piece of code and a node are, as digests that are the same in every process on every machine.

Three digests, each of tagged canonical bytes (1 and "1" differ, no two values share an encoding), pinned by golden tests:

    artifact_digest   what an artifact holds: schema name and version, field names, dtypes, shapes, bytes
    code_digest       in `own_code`, what a task does: the syntax trees of the definitions that its function reaches by name
    node_key          task name + code digest + params + input digests: what a node will compute, before it is computed
"""

import hashlib
import math
import struct
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kinetree.schemas.array import Artifact

DIGEST_BYTES = 20
_LENGTH = struct.Struct(">Q").pack


def digest(value: Any) -> str:
    """Digest of a plain value: None, bool, int, float, str, bytes, sequences and string-keyed mappings of those.

    returns : 40 hexadecimal digits (BLAKE2b, 20 bytes)
    raises  : TypeError for anything else, so that nothing is ever identified by its address or its repr
    """
    h = _hasher()
    h.update(encoded(value))
    return h.hexdigest()


def array_digest(array: NDArray[Any]) -> str:
    """Digest of an array's dtype, shape and little-endian C-order bytes."""
    stored = np.ascontiguousarray(array, dtype=array.dtype.newbyteorder("<"))
    h = _hasher()
    h.update(encoded(("array", stored.dtype.str, list(array.shape))))
    h.update(stored.reshape(-1).view(np.uint8).data)
    return h.hexdigest()


def file_digest(path: Path) -> str:
    """Digest of a file's bytes; raises OSError where they cannot be read."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, _hasher).hexdigest()


def artifact_digest(artifact: Artifact) -> str:
    """Digest of everything an artifact holds, save the fields that only say where bytes lie."""
    arrays = {name: array_digest(array) for name, array in artifact.arrays().items()}
    return combined_digest(type(artifact), artifact.plain(), arrays)


def combined_digest(cls: type[Artifact], plain: Mapping[str, Any], arrays: Mapping[str, str]) -> str:
    """The artifact digest from its parts: JSON fields and the digest of each array."""
    locations = _location_fields(cls)
    identity = {name: value for name, value in plain.items() if name not in locations}
    return digest(["kinetree.artifact/1", cls.__name__, cls.version, identity, dict(arrays)])


@cache
def _location_fields(cls: type[Artifact]) -> frozenset[str]:
    return cls.location_fields()


def node_key(
    task: str,
    code: str,
    params: "Mapping[str, Any] | Encoded",
    inputs: Sequence[Any],
    index: Sequence[int] | None = None,
) -> str:
    """Digest of what a node will compute.

    params : or their encoding, where many nodes have the same

    inputs : one [argument name, form, digests] per argument in the order of the signature; digests as `input_identity`
    index  : the node's index, for a task that asks for it; it is no part of any other key
    """
    asked = [] if index is None else [["index", *index]]
    return digest(["kinetree.node/1", task, code, params, list(inputs), *asked])


def _hasher() -> "hashlib.blake2b":
    return hashlib.blake2b(digest_size=DIGEST_BYTES)


class Encoded(bytes):
    """What `encoded` made of a value; it stands for that value within another."""


def encoded(value: Any) -> Encoded:
    """Tag, length and content of a value, so that every value has exactly one encoding and no two share it."""
    pieces: list[bytes] = []
    _encode(value, pieces.append)
    return Encoded(b"".join(pieces))


def _encode(value: Any, put: Callable[[bytes], object]) -> None:
    kind = type(value)
    if kind is str:
        text = value.encode("utf-8", "surrogatepass")
        put(b"s" + _LENGTH(len(text)) + text)
    elif kind is list or kind is tuple:
        put(b"l" + _LENGTH(len(value)))
        for item in value:
            _encode(item, put)
    elif value is None:
        put(b"N")
    elif kind is bool:
        put(b"T" if value else b"F")
    elif kind is int:
        text = str(value).encode()
        put(b"i" + _LENGTH(len(text)) + text)
    elif kind is float:
        put(b"f" + struct.pack(">d", value if value == value else math.nan))  # one NaN, whatever its bits
    elif kind is bytes:
        put(b"b" + _LENGTH(len(value)) + value)
    elif kind is Encoded:
        put(value)
    elif isinstance(value, Mapping):
        put(b"d" + _LENGTH(len(value)))
        for name in sorted(value, key=_text):
            _encode(name, put)
            _encode(value[name], put)
    elif isinstance(value, list | tuple):
        _encode(list(value), put)
    else:
        raise TypeError(f"no canonical encoding for {kind.__name__}: {value!r}")


def _text(name: Any) -> str:
    if type(name) is not str:
        raise TypeError(f"mapping keys must be strings to have a canonical order, got {name!r}")
    return name
