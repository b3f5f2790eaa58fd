"""Digests of the user's files, remembered: a file whose size, times and inode did not change is not read again.

The memory is a convenience that may be lost or shared at any time. A file touched within the last seconds is read again,
because its next change might leave no trace in its times. An altered byte makes the store forget all of it.
"""

import os
import time
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from kinetree.pipeline.key import file_digest
from kinetree.pipeline.sealed import sealed, unsealed
from kinetree.pipeline.store import Store

MEMORY = "files.json"
SETTLED_SECONDS = 2.0
UNREADABLE = "unreadable: "


@dataclass
class Files:
    """Gives digests of files and of the parts of files; `save` keeps what was learnt in the store."""

    store: Store
    _known: dict[str, Any] = field(default_factory=dict)
    _learnt: bool = False

    @staticmethod
    def of(store: Store) -> "Files":
        """The memory that this store keeps, empty where there is none or it is unreadable."""
        known = unsealed(store.place.get(MEMORY))
        return Files(store, known if isinstance(known, dict) else {})

    def digests(self, paths: Sequence[Path]) -> list[str]:
        """Digest of the bytes of each file; "unreadable: …" for one that cannot be read, so that its node can say so."""
        with ThreadPoolExecutor(min(8, len(os.sched_getaffinity(0)) * 2)) as pool:
            return [parts[0] for parts in pool.map(lambda path: self._remembered(path, "bytes", _bytes), paths)]

    def parts(self, path: Path, kind: str, read: Callable[[Path], Sequence[str]]) -> Sequence[str]:
        """Digests of the parts of one file (or of a folder of files) as `read` makes them; `kind` names how."""
        return self._remembered(path, kind, read)

    def save(self) -> None:
        """Keeps what was learnt, where the store exists."""
        if self._learnt and self.store.exists:
            self.store.place.put(MEMORY, sealed(self._known))

    def _remembered(self, path: Path, kind: str, read: Callable[[Path], Sequence[str]]) -> Sequence[str]:
        stamp = _stamp(path)
        name = f"{kind}:{path}"
        entry = self._known.get(name)
        if stamp is not None and isinstance(entry, list) and len(entry) == 2 and entry[0] == stamp:
            digests: list[str] = entry[1]
            return digests
        digests = list(read(path))
        lasting = not digests or not digests[0].startswith(UNREADABLE)
        if lasting and stamp is not None and stamp == _stamp(path) and time.time() - stamp[1] / 1e9 > SETTLED_SECONDS:
            self._known[name] = [stamp, digests]
            self._learnt = True
        return digests


def _bytes(path: Path) -> list[str]:
    try:
        return [file_digest(path)]
    except OSError as error:
        return [f"{UNREADABLE}{error.strerror}"]


def _stamp(path: Path) -> list[int] | None:
    """Total size, latest times and a sum of the inodes of a file, or of all files below a folder."""
    try:
        stats = [file.stat() for file in (_below(path) if path.is_dir() else (path,))]
    except OSError:
        return None
    if not stats:
        return None
    newest = max(max(s.st_mtime_ns, s.st_ctime_ns) for s in stats)
    return [sum(s.st_size for s in stats), newest, sum(s.st_mtime_ns for s in stats) % 2**53, sum(s.st_ino for s in stats)]


def _below(path: Path) -> Iterable[Path]:
    return (file for file in sorted(path.rglob("*")) if file.is_file())
