"""What a task does, as digests of the syntax trees of the definitions that its function reaches by name."""

import contextlib
import gc
import importlib.util
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path

from kinetree.pipeline.identity.code_cache import CodeCache, Identified
from kinetree.pipeline.identity.definitions import Code
from kinetree.pipeline.identity.key import digest
from kinetree.pipeline.identity.modules import IMPORTS, PACKAGE, STATEMENTS, Definition

PART_DIGITS = 6
"""Of a definition's digest in a record, which only tells people what changed: every node keeps one for each definition."""
CODE_ROOTS = ("kinetree.tasks", "kinetree.schemas")
"""Packages whose modules can change a result. For a task that somebody else's package defines, that package counts too."""
HARMLESS = ("kinetree.pipeline", "kinetree.errors")
"""Packages that may not change a result."""


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
