"""Compiled code on disk: one file for each function, types of arguments and processor, which says itself what it holds.

Numba keeps an index of each function's files, numbered from 1. Two processes that compile it for different types at once can
take the same number, and the index of one then names the code of the other. Here nothing is read, changed and written back.
"""

import contextlib
import hashlib
import pickle
import secrets
import sys
import time
from pathlib import Path
from typing import Any

import numba
from numba.core.caching import FunctionCache
from numba.core.serialize import dumps

CHECKSUM_BYTES = 16
WRITING_SECONDS = 3600.0
"""After which a file beside another is what a writer left that was killed; writing one takes milliseconds."""


class KernelCache(FunctionCache):  # type: ignore[misc]
    """Numba's cache of a function with files of our own; a numba that does not ask for `_cache_file` keeps its own."""

    def __init__(self, function: Any) -> None:
        super().__init__(function)
        name = f"{function.__qualname__.replace('<', '').replace('>', '')}-{function.__code__.co_firstlineno}"
        self._cache_file = KernelFiles(Path(self.cache_path), name)

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keeps compiled code; where the disk is full it is not kept, and no call fails of that."""
        with contextlib.suppress(OSError):
            super().save_overload(sig, data)


class KernelFiles:
    """The files of one function, each written beside and renamed; what numba asks of its own `IndexDataCacheFile`."""

    def __init__(self, folder: Path, name: str) -> None:
        self._folder, self._name = folder, name

    def save(self, key: Any, data: Any) -> None:
        """Keeps data under a key, in place of what was there; raises OSError."""
        content = dumps((key, data))
        path = self._path(key)
        beside = path.with_name(f"{path.name}.{secrets.token_hex(8)}")  # as `remove_abandoned` looks for them
        try:
            beside.write_bytes(_checksum(content) + content)
            beside.replace(path)
        finally:
            beside.unlink(missing_ok=True)

    def load(self, key: Any) -> Any:
        """The data under a key; None where there is none, or its file is damaged."""
        try:
            content = self._path(key).read_bytes()
        except OSError:
            return None
        checksum, content = content[:CHECKSUM_BYTES], content[CHECKSUM_BYTES:]
        if checksum != _checksum(content):
            return None
        saved, data = pickle.loads(content)  # written by this user, into this user's own cache
        return data if saved == key else None

    def flush(self) -> None:
        """Removes every file."""
        for path in self._folder.glob(f"{self._name}.*"):
            path.unlink(missing_ok=True)

    def _path(self, key: Any) -> Path:
        """Named by the text of the key, of which that of types need not be unique: the file has the key itself."""
        text = "\0".join((numba.__version__, sys.version, repr(key)))
        return self._folder / f"{self._name}.{hashlib.blake2b(text.encode(), digest_size=10).hexdigest()}.nbc"


def remove_abandoned(folder: Path) -> None:
    """Removes what writers that were killed left below the folder of one state of the code."""
    before = time.time() - WRITING_SECONDS
    for path in folder.glob("*/*.nbc.*"):
        with contextlib.suppress(OSError):  # somebody else removes it too, or may and we may not
            if path.stat().st_mtime < before:
                path.unlink()


def _checksum(content: bytes) -> bytes:
    return hashlib.blake2b(content, digest_size=CHECKSUM_BYTES).digest()
