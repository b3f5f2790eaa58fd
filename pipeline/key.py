"""Identity: what a value, a piece of code and a node are, as digests that are the same in every process on every machine.

Three digests, each of tagged canonical bytes (1 and "1" differ, no two values share an encoding), pinned by golden tests:

    artifact_digest   what an artifact holds: schema name and version, field names, dtypes, shapes, bytes
    code_digest       what a task does: the syntax trees of its module and of every task and schema module it imports
    node_key          task name + code digest + params + input digests: what a node will compute, before it is computed
"""

import ast
import hashlib
import importlib.util
import math
import struct
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kinetree.schemas.array import Artifact

DIGEST_BYTES = 20
_LENGTH = struct.Struct(">Q").pack
CODE_ROOTS = ("kinetree.tasks", "kinetree.schemas")
"""Packages whose modules can change a result; `kinetree.pipeline` is not among them because it may not. For a task that
somebody else's package defines, that package counts too."""


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
    told = {name: value for name, value in plain.items() if name not in cls.location_fields()}
    return digest(["kinetree.artifact/1", cls.__name__, cls.version, told, dict(arrays)])


def node_key(
    task: str, code: str, params: Mapping[str, Any], inputs: Sequence[Any], index: Sequence[int] | None = None
) -> str:
    """Digest of what a node will compute.

    inputs : one [argument name, form, digests] per argument in the order of the signature; digests as `input_identity`
    index  : the node's index, for a task that asks for it; it is no part of any other key
    """
    asked = [] if index is None else [["index", *index]]
    return digest(["kinetree.node/1", task, code, dict(params), list(inputs), *asked])


def code_digest(module: str) -> str:
    """Digest of the comment-free, docstring-free code of `module` and of all task and schema code it can reach."""
    return digest(["kinetree.code/1", code_closure(module)])


@cache
def code_closure(module: str) -> dict[str, str]:
    """Digest of the code of `module` and of every module of `CODE_ROOTS` it imports, transitively, by module name."""
    package = module.partition(".")[0]
    roots = CODE_ROOTS if package == "kinetree" else (*CODE_ROOTS, package)
    found: dict[str, str] = {}
    waiting = [module]
    while waiting:
        name = waiting.pop()
        if name not in found:
            found[name], imports = _module(name, roots)
            waiting.extend(imports)
    return dict(sorted(found.items()))


def forget_code() -> None:
    """Makes the code be read again, for a process that reloads its modules after an edit."""
    code_closure.cache_clear()
    _module.cache_clear()


@cache
def _module(name: str, roots: Sequence[str]) -> tuple[str, tuple[str, ...]]:
    """Digest of one module's code, and the modules below `roots` that it imports."""
    tree = ast.parse(_source(name))
    return digest(["kinetree.module/1", *_syntax(tree)]), tuple(dict.fromkeys(_imports(tree, name, roots)))


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


def _syntax(node: ast.AST) -> list[Any]:
    """The tree as plain values: no positions, no bare strings (docstrings), no field that is empty.

    Fields that are empty are left out because Python versions differ in which empty fields a node has.
    """
    told: list[Any] = [type(node).__name__]
    for field in node._fields:
        value = getattr(node, field, None)
        if isinstance(value, list):
            items = [i for i in value if not _is_docstring(i)]
            if items:
                told.append([field, [_syntax(i) if isinstance(i, ast.AST) else i for i in items]])
        elif isinstance(value, ast.AST):
            told.append([field, _syntax(value)])
        elif value is not None:
            told.append([field, type(value).__name__, repr(value)])
    return told


def _is_docstring(node: Any) -> bool:
    """A string that stands alone as a statement: it documents and cannot change a result."""
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)


def _imports(tree: ast.AST, module: str, roots: Sequence[str]) -> Iterator[str]:
    """The modules below `roots` that a module's import statements name, wherever in it they stand."""
    for node in ast.walk(tree):
        names: list[str] = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            package = module if _is_package(module) else module.rpartition(".")[0]
            origin = importlib.util.resolve_name("." * node.level + (node.module or ""), package)
            inner = [f"{origin}.{alias.name}" for alias in node.names]
            names = [name if _counts(name, roots) and _exists(name) else origin for name in inner]
        yield from (name for name in names if _counts(name, roots))


def _counts(name: str, roots: Sequence[str]) -> bool:
    return any(name == root or name.startswith(root + ".") for root in roots)


def _exists(name: str) -> bool:
    """Whether `name` is a module (and not something a module defines)."""
    if name in sys.modules:
        return True
    try:
        return importlib.util.find_spec(name) is not None
    except ModuleNotFoundError:
        return False


def _is_package(module: str) -> bool:
    if module in sys.modules:
        return hasattr(sys.modules[module], "__path__")
    spec = importlib.util.find_spec(module)
    return spec is not None and spec.submodule_search_locations is not None


def _source(module: str) -> str:
    spec = importlib.util.find_spec(module)
    if spec is None or spec.origin is None:
        raise ModuleNotFoundError(f"no source for module {module!r}; its code cannot be identified", name=module)
    return Path(spec.origin).read_text(encoding="utf-8")
