"""Digests of the user's files, remembered: a file whose size, times and inode did not change is not read again.

The memory is a convenience that may be lost or shared at any time. A file touched within the last seconds is read again,
because its next change might leave no trace in its times. An altered byte makes the store forget all of it. A file may lie
in a bucket (remote.py); then what its service tells of it in a listing takes the place of times and inode.
"""

import contextlib
import os
import sys
import time
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from kinetree.errors import StoreError
from kinetree.pipeline.identity.key import file_digest
from kinetree.pipeline.storage.place import Listed
from kinetree.pipeline.storage.remote import ASKED_AT_ONCE, copied, is_remote, listed_files, look
from kinetree.pipeline.storage.sealed import sealed, unsealed
from kinetree.pipeline.storage.store import Store

MEMORY = "files.json"
SETTLED_SECONDS = 2.0
UNREADABLE = "unreadable: "


def _nothing() -> None:
    """Nobody wants to know."""


@dataclass
class Settling:
    """Which files are complete: those that stood still from one look to the next."""

    _before: dict[Path, tuple[int, ...]] = field(default_factory=dict)
    _now: dict[Path, tuple[int, ...]] = field(default_factory=dict)

    def look(self) -> None:
        """Another look begins: what is asked from now on is compared with the look before."""
        self._before, self._now = self._now, {}

    def is_complete(self, path: Path) -> bool:
        """Whether a file is as it was in the look before; not the first time that it is seen."""
        try:
            stat = path.stat()
        except OSError:
            return False
        self._now[path] = (stat.st_size, stat.st_mtime_ns, stat.st_ino)
        return self._before.get(path) == self._now[path]


@dataclass
class Files:
    """Gives digests of files and of the parts of files; `save` keeps what was learnt in the store."""

    store: Store
    settling: Settling | None = None
    """Which files are complete while the input grows; None takes all as they are."""
    unknown: Callable[[], None] = _nothing
    """Called before a file is read of which nothing is remembered: there will be something to compute."""
    _known: dict[str, Any] = field(default_factory=dict)
    _learnt: bool = False
    _listed: dict[str, Listed] = field(default_factory=dict)
    """What lies in buckets, by address."""

    @staticmethod
    def of(store: Store, settling: Settling | None = None, unknown: Callable[[], None] = _nothing) -> "Files":
        """The memory that this store keeps, empty where there is none or it is unreadable."""
        known = unsealed(store.place.get(MEMORY))
        return Files(store, settling, unknown, known if isinstance(known, dict) else {})

    def complete(self, paths: Sequence[Path]) -> list[Path]:
        """Those of the paths whose file is complete: all of them, unless the input is followed as it grows."""
        return [path for path in paths if self.settling is None or self.settling.is_complete(path)]

    @staticmethod
    def is_remote(where: str) -> bool:
        """Whether this is an address in a bucket, which `addresses` reads, and not a path."""
        return is_remote(where)

    def addresses(self, where: str) -> list[str]:
        """The addresses at a folder, a pattern or an address in a bucket, sorted; raises InputError where there are none."""
        by_address = listed_files(where)
        self._listed |= by_address
        return list(by_address)

    def digests(self, paths: Sequence[Path | str], most: int = sys.maxsize) -> list[str]:
        """Digest of the bytes of each file; "unreadable: …" for one that cannot be read, so that its node can say so.

        most : bytes beyond which a file is not read
        """
        with ThreadPoolExecutor(min(8, len(os.sched_getaffinity(0)) * 2)) as pool:
            read = partial(_bytes, most=most)
            return [parts[0] for parts in pool.map(lambda path: self._remembered(path, "bytes", read), paths)]

    def parts(self, path: Path | str, kind: str, read: Callable[[Path], Sequence[str]]) -> Sequence[str]:
        """Digests of the parts of one file (or of a folder of files) as `read` makes them; `kind` names how.

        read : is given the file, or a copy of it where it lies in a bucket
        """
        return self._remembered(path, kind, read)

    def parts_of_each(
        self, paths: Sequence[Path | str], kind: str, read: Callable[[Path], Sequence[str]]
    ) -> list[Sequence[str]]:
        """The same of many files, several at a time: where they lie in buckets most of the time is waiting."""
        with ThreadPoolExecutor(ASKED_AT_ONCE) as pool:
            return list(pool.map(lambda path: self._remembered(path, kind, read), paths))

    def save(self) -> None:
        """Keeps what was learnt, where the store exists and can be written; what is forgotten is read again."""
        if self._learnt and self.store.exists:
            with contextlib.suppress(StoreError):
                self.store.place.put(MEMORY, sealed(self._known))

    def _remembered(self, path: Path | str, kind: str, read: Callable[[Path], Sequence[str]]) -> Sequence[str]:
        listed = self._listed.get(str(path)) or (look(str(path)) if is_remote(path) else None)
        stamp = _stamp(Path(path)) if listed is None else [listed.size, listed.modified, listed.tag]
        name = f"{kind}:{path}"
        entry = self._known.get(name)
        if stamp is not None and isinstance(entry, list) and len(entry) == 2 and entry[0] == stamp:
            digests: list[str] = entry[1]
            return digests
        self.unknown()
        with copied(str(path)) if is_remote(path) else contextlib.nullcontext(Path(path)) as file:
            digests = list(read(file))
        if (not digests or not digests[0].startswith(UNREADABLE)) and stamp is not None and _has_settled(path, stamp):
            self._known[name] = [stamp, digests]
            self._learnt = True
        return digests


def _has_settled(path: Path | str, stamp: list[Any]) -> bool:
    """Whether the next change of a file will leave a trace in its stamp."""
    if is_remote(path):
        return bool(stamp[-1])  # a service names every state of an object
    return stamp == _stamp(Path(path)) and time.time() - stamp[1] / 1e9 > SETTLED_SECONDS


def _bytes(path: Path, most: int) -> list[str]:
    try:
        if path.stat().st_size > most:
            return [f"{UNREADABLE}more than {most} bytes"]
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
