"""`@compiled`: a function compiled by numba, kept on disk, run without the interpreter's lock.

Numba keeps compiled code beside the digest of the file it stands in, but compiled code holds what it calls in other files
too: after an edit there, or an upgrade, the old code would run on. So the place where it is kept is named by the digest
of the file and of every numeric file it imports, and by nothing else: installations of the same code share it.
"""

import contextlib
import hashlib
import importlib.util
import os
import re
import sys
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

import numba
from numba.core.caching import UserProvidedCacheLocator

from kinetree.tasks.numerics.kernel_cache import KernelCache, remove_abandoned
from kinetree.tasks.numerics.kernel_folder import kernel_folder

Function = TypeVar("Function", bound=Callable[..., Any])
PACKAGE = "kinetree.tasks.numerics"
LOCATOR = "kinetree.tasks.numerics.compiled.SharedCacheLocator"


class SharedCacheLocator(UserProvidedCacheLocator):  # type: ignore[misc]
    """Keeps the compiled code in the folder of `CACHE_DIR` itself, wherever the source lies."""

    @classmethod
    def get_suitable_cache_subpath(cls, py_file: str) -> str:
        """The folder below `CACHE_DIR`; numba's own is named by the path of the source, which a copy does not share."""
        return Path(py_file).stem


def compiled(function: Function) -> Function:
    """Numba's `njit` without the lock and without checks for division by nought, kept where only this code can find it."""
    folder = _code_folder(function.__module__)
    with _configured(CACHE_DIR=folder, CACHE_LOCATOR_CLASSES=LOCATOR):
        dispatcher: Function = numba.njit(nogil=True, error_model="numpy")(function)
        if folder:
            dispatcher._cache = KernelCache(function)  # type: ignore[attr-defined]  # njit(cache=True) makes numba's own
    return dispatcher


@contextlib.contextmanager
def _configured(**values: str) -> Iterator[None]:
    """Sets what this version of numba can be told, for the time of a block."""
    before = {name: getattr(numba.config, name) for name in values if hasattr(numba.config, name)}
    try:
        for name in before:
            setattr(numba.config, name, values[name])
        yield
    finally:
        for name, value in before.items():
            setattr(numba.config, name, value)


@cache
def _code_folder(module: str) -> str:
    """A folder of the user's own cache; "" where none can be written, and code is compiled anew in every process."""
    folder = kernel_folder() / _digest(module)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return ""
    remove_abandoned(folder)
    return str(folder) if os.access(folder, os.W_OK) else ""


@cache
def _digest(module: str) -> str:
    """Digest of the module's text and of every numeric module it imports, transitively."""
    texts: dict[str, str] = {}
    waiting = [module]
    while waiting:
        name = waiting.pop()
        if name not in texts:
            texts[name] = _text(name)
            waiting += re.findall(rf"^\s*(?:from|import) ({PACKAGE}\.\w[\w.]*)", texts[name], re.MULTILINE)
    text = "\0".join(f"{name}\0{texts[name]}" for name in sorted(texts))
    return hashlib.blake2b(text.encode(), digest_size=10).hexdigest()


def _text(module: str) -> str:
    spec = getattr(sys.modules.get(module), "__spec__", None) or importlib.util.find_spec(module)
    return Path(spec.origin).read_text(encoding="utf-8") if spec is not None and spec.origin else ""
