"""Identity: what a value, a piece of code and a node are, as digests that are the same in every process on every machine.

Three digests, each of tagged canonical bytes (1 and "1" differ, no two values share an encoding), pinned by golden tests:

    artifact_digest   what an artifact holds: schema name and version, field names, dtypes, shapes, bytes
    code_digest       what a task does: the syntax trees of the definitions that its function reaches by name
    node_key          task name + code digest + params + input digests: what a node will compute, before it is computed
"""

import contextlib
import gc
import hashlib
import importlib.util
import math
import struct
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kinetree.pipeline.identity.code_cache import CodeCache, Identified
from kinetree.pipeline.identity.definitions import Code
from kinetree.pipeline.identity.modules import IMPORTS, PACKAGE, STATEMENTS, Definition
from kinetree.schemas.array import Artifact

DIGEST_BYTES = 20
PART_DIGITS = 6
"""Of a definition's digest in a record, which only tells people what changed: every node keeps one for each definition."""
_LENGTH = struct.Struct(">Q").pack
CODE_ROOTS = ("kinetree.tasks", "kinetree.schemas")
"""Packages whose modules can change a result. For a task that somebody else's package defines, that package counts too."""
HARMLESS = ("kinetree.pipeline", "kinetree.errors")
"""Packages that may not change a result."""


def digest(value: Any) -> str:
    """Digest of a plain value: None, bool, int, float, str, bytes, sequences and string-keyed mappings of those.

    returns : 40 hexadecimal digits (BLAKE2b, 20 bytes)
    raises  : TypeError for anything else, so that nothing is ever identified by its address or its repr
    """
    h = _hasher()
    h.update(_encoded(value))
    return h.hexdigest()


def array_digest(array: NDArray[Any]) -> str:
    """Digest of an array's dtype, shape and little-endian C-order bytes."""
    stored = np.ascontiguousarray(array, dtype=array.dtype.newbyteorder("<"))
    h = _hasher()
    h.update(_encoded(("array", stored.dtype.str, list(array.shape))))
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


def node_key(task: str, code: str, params: Mapping[str, Any], inputs: Sequence[Any], index: Sequence[int] | None = None) -> str:
    """Digest of what a node will compute.

    inputs : one [argument name, form, digests] per argument in the order of the signature; digests as `input_identity`
    index  : the node's index, for a task that asks for it; it is no part of any other key
    """
    asked = [] if index is None else [["index", *index]]
    return digest(["kinetree.node/1", task, code, dict(params), list(inputs), *asked])


def code_digest(module: str, name: str) -> str:
    """Digest of the definitions that `name` of `module` reaches, without comments and docstrings.

    raises : ModuleNotFoundError where there is no source of `module`
    """
    return _identified(module, name)[0]


def code_parts(module: str, name: str) -> Mapping[str, str]:
    """What a code digest is made of, for people: by module, the names of its definitions, each with a short digest.

    returns : for example {"kinetree.tasks.numerics.mu": "(imports):9f03a1 bases:5512c0 mu:0b7e44"}
    """
    return _identified(module, name)[1]


def keep_code() -> None:
    """Keeps on disk the code digests asked for so far, so that the next process need not compute them."""
    _kept_code().save()


@cache
def _identified(module: str, name: str) -> Identified:
    if not is_own_code(module):
        return _computed(module, name)
    cache_file, task = _kept_code(), f"{module}:{name}"
    if task not in cache_file.known:
        cache_file.add(task, _computed(module, name))
    return cache_file.known[task]


def _computed(module: str, name: str) -> Identified:
    code = _code(CODE_ROOTS if is_own_code(module) else (*CODE_ROOTS, module.partition(".")[0]))
    with _collection_paused():
        reached = code.reached(module, name)
    digests: dict[Definition, str] = {}
    for one, syntax in reached.items():
        known = None if one[1] in (STATEMENTS, IMPORTS) else code.digests.get(one)
        digests[one] = code.digests[one] = known or digest(["kinetree.definition/1", syntax])
    parts: dict[str, str] = {}
    for (home, definition), part in digests.items():
        parts[home] = f"{parts.get(home, '')} {definition}:{part[:PART_DIGITS]}".lstrip()
    return digest(["kinetree.code/2", name, [[*one, part] for one, part in digests.items()]]), parts


@contextlib.contextmanager
def _collection_paused() -> Iterator[None]:
    """Syntax trees are many objects and no garbage: looking through them again and again takes as long as all the rest."""
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()


def code_state() -> str:
    """Digest of all texts that code digests of our own tasks can be made of; read once, like the digests themselves."""
    return _kept_code().path.stem


def is_code_as_read() -> bool:
    """Whether no file of our own code was edited since it was digested: what is imported only now is what was planned with."""
    return _stamps() == _kept_stamps()


def is_own_code(module: str) -> bool:
    """Whether a module is of the packages that always count; others' texts change too often to be worth keeping."""
    return f"{module}.".startswith(tuple(f"{root}." for root in CODE_ROOTS))


def source_of(module: str) -> Path | None:
    """The file of a module of our own code, which is not imported; None where there is none."""
    paths = _paths(CODE_ROOTS)
    return paths.get(module) or paths.get(f"{module}{PACKAGE}")


def forget_code() -> None:
    """Makes the code be read again, for a process that reloads its modules after an edit."""
    for remembered in (_identified, _code, _paths, _kept_code, _kept_stamps):
        remembered.cache_clear()


@cache
def _kept_code() -> CodeCache:
    _kept_stamps()  # before the texts are read: an edit between the two is one that is noticed
    return CodeCache.of(_code(CODE_ROOTS).texts)


@cache
def _kept_stamps() -> Mapping[str, tuple[int, int]]:
    return _stamps()


def _stamps() -> Mapping[str, tuple[int, int]]:
    """Time and size of every file of our own code."""
    stamps: dict[str, tuple[int, int]] = {}
    for name, path in (row for root in CODE_ROOTS for row in _files(root)):
        with contextlib.suppress(OSError):
            stat = path.stat()
            stamps[name] = stat.st_mtime_ns, stat.st_size
    return stamps


@cache
def _code(roots: tuple[str, ...]) -> Code:
    return Code(_Texts(_paths(roots)), HARMLESS)


@cache
def _paths(roots: tuple[str, ...]) -> dict[str, Path]:
    return {name: path for root in roots for name, path in _files(root)}


def _files(root: str) -> Iterator[tuple[str, Path]]:
    """The modules of an installed package by name, none of which is imported; a package's own is `package.__init__`."""
    spec = importlib.util.find_spec(root)
    if spec is None:
        return
    if spec.submodule_search_locations is None and spec.origin is not None:
        yield root, Path(spec.origin)
    for folder in spec.submodule_search_locations or ():
        for path in Path(folder).rglob("*.py"):
            yield ".".join((root, *path.relative_to(folder).with_suffix("").parts)), path


class _Texts(Mapping[str, str]):
    """The texts of modules, read when they are asked for."""

    def __init__(self, paths: dict[str, Path]) -> None:
        self._paths = paths

    def __getitem__(self, name: str) -> str:
        return self._paths[name].read_text(encoding="utf-8")

    def __contains__(self, name: object) -> bool:
        return name in self._paths

    def __iter__(self) -> Iterator[str]:
        return iter(self._paths)

    def __len__(self) -> int:
        return len(self._paths)


def _hasher() -> "hashlib.blake2b":
    return hashlib.blake2b(digest_size=DIGEST_BYTES)


def _encoded(value: Any) -> bytes:
    """Tag, length and content of a value, so that every value has exactly one encoding and no two share it."""
    pieces: list[bytes] = []
    _encode(value, pieces.append)
    return b"".join(pieces)


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
