"""Where bytes lie: the few things a store asks of a file system, so that a bucket can be one as well as a folder.

A path is relative, with forward slashes. `put` is all or nothing: a reader sees the old or the new, never half.
"""

import contextlib
import errno
import os
import shutil
import uuid
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, Protocol, TypeVar

from kinetree.errors import ReadOnlyStoreError, StoreError, StoreFullError

T = TypeVar("T")


@dataclass(frozen=True)
class Listed:
    """What a listing says of one object."""

    size: int
    modified: float
    """Seconds since the epoch of its last change."""
    tag: str = ""
    """What a service calls this state of its bytes; empty where it does not say."""


class Place(Protocol):
    """What a store needs; `Folder` is the one on a disk."""

    url: str
    is_remote: bool
    """Whether one question takes about as long as listing a thousand objects, so that many are better asked at once."""

    def get(self, path: str) -> bytes | None:
        """The bytes at `path`; None where nothing is."""

    def get_all(self, paths: Iterable[str]) -> dict[str, bytes | None]:
        """The bytes at every path, in their order; None where nothing is."""

    def tail(self, path: str, count: int) -> tuple[bytes, int] | None:
        """The last bytes of an object, and how many it has in all; None where nothing is."""

    def part(self, path: str, start: int, stop: int) -> bytes | None:
        """The bytes from start to stop; None where nothing is."""

    def put(self, path: str, data: bytes) -> None:
        """Writes one object."""

    def size(self, path: str) -> int | None:
        """Bytes of one object; None where nothing is."""

    def names(self, path: str) -> list[str]:
        """Names directly below `path`, sorted; empty where nothing is."""

    def listed(self, path: str) -> dict[str, Listed]:
        """Every object below `path`, by path relative to it, sorted; empty where nothing is."""

    def modified(self, path: str) -> float:
        """Seconds since the epoch of the last change of an object; 0 where nothing is."""

    def remove(self, path: str) -> None:
        """Removes an object; nothing happens where nothing is."""

    def remove_all(self, paths: Iterable[str]) -> None:
        """Removes objects; nothing happens where nothing is."""


class Folder:
    """A `Place` on a local or mounted disk: written beside, then renamed."""

    is_remote = False

    def __init__(self, root: Path, name: str = "store", beside: str = "tmp") -> None:
        self.root = root.absolute()
        self.url = str(self.root)
        self._name = name
        self._folder = self.root / beside

    def get(self, path: str) -> bytes | None:
        """The bytes at `path`; None where nothing is."""
        return self._read(path, lambda file: file.read())

    def get_all(self, paths: Iterable[str]) -> dict[str, bytes | None]:
        """The bytes at every path, one after the other; None where nothing is."""
        return {path: self.get(path) for path in paths}

    def tail(self, path: str, count: int) -> tuple[bytes, int] | None:
        """The last bytes of a file, and how many it has in all; None where nothing is."""

        def tail(file: BinaryIO) -> tuple[bytes, int]:
            size = file.seek(0, os.SEEK_END)
            file.seek(max(0, size - count))
            return file.read(), size

        return self._read(path, tail)

    def part(self, path: str, start: int, stop: int) -> bytes | None:
        """The bytes from start to stop; None where nothing is."""

        def part(file: BinaryIO) -> bytes:
            file.seek(start)
            return file.read(stop - start)

        return self._read(path, part)

    def put(self, path: str, data: bytes) -> None:
        """Writes one object beside, then renames."""
        self.refuse_outside(path)
        with self._refusals(path):
            target = self.root / path
            target.parent.mkdir(parents=True, exist_ok=True)
            beside = self._beside()
            try:
                beside.write_bytes(data)
                beside.replace(target)
            finally:
                beside.unlink(missing_ok=True)

    def put_all(self, path: str, files: Mapping[str, bytes]) -> None:
        """Writes a tree beside, then renames it whole; a tree that is there with the same sizes stays."""
        for name in files:
            self.refuse_outside(f"{path}/{name}")
        self.refuse_outside(path)
        with self._refusals(path):
            target = self.root / path
            beside = self._beside()
            try:
                for name, data in files.items():
                    file = beside / name
                    file.parent.mkdir(parents=True, exist_ok=True)
                    file.write_bytes(data)
                target.parent.mkdir(parents=True, exist_ok=True)
                self._rename_tree(beside, target, {name: len(data) for name, data in files.items()})
            finally:
                shutil.rmtree(beside, ignore_errors=True)

    def size(self, path: str) -> int | None:
        """Bytes of one object; None where nothing is."""
        try:
            return os.stat(f"{self.url}/{path}").st_size  # noqa: PTH116 - a third of the time of pathlib, ten thousand times
        except OSError:
            return None

    def names(self, path: str) -> list[str]:
        """Names directly below `path`, sorted; empty where nothing is."""
        try:
            return sorted(entry.name for entry in (self.root / path).iterdir())
        except (FileNotFoundError, NotADirectoryError):
            return []
        except OSError as error:
            raise StoreError(f"store {self.url}: cannot list {path}: {error.strerror}; check its permissions") from error

    def listed(self, path: str) -> dict[str, Listed]:
        """Every file below `path`, by path relative to it, sorted; empty where nothing is, and behind a link that leads out."""
        if not self._holds(path):
            return {}
        try:
            return dict(sorted(_listed(f"{self.url}/{path}", "")))
        except OSError as error:
            raise StoreError(f"store {self.url}: cannot list {path}: {error.strerror}; check its permissions") from error

    def modified(self, path: str) -> float:
        """Seconds since the epoch of the last change; 0 where nothing is."""
        try:
            return (self.root / path).stat().st_mtime
        except OSError:
            return 0.0

    def remove(self, path: str) -> None:
        """Removes a file at once; renames a tree away first, so that no reader meets half of it."""
        self.refuse_outside(path)
        with self._refusals(path), contextlib.suppress(FileNotFoundError):
            try:
                (self.root / path).unlink()
            except (IsADirectoryError, PermissionError):  # which of them a folder is depends on the system
                beside = self._beside()
                (self.root / path).rename(beside)
                shutil.rmtree(beside, ignore_errors=True)

    def remove_all(self, paths: Iterable[str]) -> None:
        """Removes one after the other."""
        for path in paths:
            self.remove(path)

    def refuse_outside(self, path: str) -> None:
        """Raises StoreError where a path is none below this folder, or a link on the way to it leads out of the folder."""
        is_plain = "\0" not in path and all(part not in ("", ".", "..") for part in path.split("/"))
        if not is_plain or not self._holds(path.rpartition("/")[0]):
            why = "does not lie in it, but behind a link that leads out" if is_plain else "does not lie in it"
            raise StoreError(f"{self._name} {self.url}: {path!r} {why}; nothing is written or removed there")

    def _holds(self, folder: str) -> bool:
        """Whether a folder below this one, which need not be there, lies below it also where links are followed."""
        names = [name for name in folder.split("/") if name]
        way = [f"{self.url}/{'/'.join(names[: depth + 1])}" for depth in range(len(names))]
        if not any(os.path.islink(step) for step in way):  # noqa: PTH114 - see `size`
            return True
        return Path(os.path.realpath(way[-1])).is_relative_to(os.path.realpath(self.root))

    def _read(self, path: str, content: Callable[[BinaryIO], T]) -> T | None:
        """What is read of an open file; None where nothing is."""
        try:
            try:
                file = open(f"{self.url}/{path}", "rb")  # noqa: PTH123, SIM115 - ten thousand times, see `size`
            except (FileNotFoundError, NotADirectoryError, IsADirectoryError):
                return None
            with file:
                return content(file)
        except OSError as error:
            raise StoreError(f"store {self.url}: cannot read {path}: {error.strerror}; check its permissions") from error

    def _beside(self) -> Path:
        beside = self._folder / f".{uuid.uuid4().hex}"
        self.refuse_outside(str(beside.relative_to(self.root)))
        self._folder.mkdir(parents=True, exist_ok=True)
        return beside

    def _rename_tree(self, beside: Path, target: Path, sizes: Mapping[str, int]) -> None:
        """Another run may have published the same tree in the meantime: equal sizes stay, anything else is damage."""
        for _ in range(3):
            try:
                beside.rename(target)
                return
            except OSError as error:
                if error.errno not in (errno.ENOTEMPTY, errno.EEXIST):
                    raise
            if all(self.size(str(target.relative_to(self.root) / name)) == size for name, size in sizes.items()):
                return
            with contextlib.suppress(FileNotFoundError):
                target.rename(self._beside())

    @contextlib.contextmanager
    def _refusals(self, path: str) -> Iterator[None]:
        """Turns the file system's refusals into the two errors a user can act on."""
        try:
            yield
        except OSError as error:
            if error.errno in (errno.ENOSPC, errno.EDQUOT):
                raise StoreFullError(
                    f"{self._name} {self.url}: no space left while writing {path}; nothing stored is lost:"
                    " free some space and run again"
                ) from error
            dangling = next((p for p in (self.root, *self.root.parents) if p.is_symlink() and not p.exists()), None)
            why = f"cannot write {path}: {error.strerror}; check its permissions"
            if dangling is not None:
                why = f"{dangling} is a link to {dangling.readlink()}, which is not there; make that folder"
            kind = ReadOnlyStoreError if error.errno in (errno.EROFS, errno.EACCES, errno.EPERM) else StoreError
            raise kind(f"{self._name} {self.url}: {why} or name another folder (--output, --store)") from error


def _listed(folder: str, prefix: str) -> Iterator[tuple[str, Listed]]:
    """The files below a folder; another run may remove what is listed here."""
    with contextlib.suppress(FileNotFoundError, NotADirectoryError), os.scandir(folder) as entries:
        for entry in entries:
            if entry.is_dir(follow_symlinks=False):
                yield from _listed(entry.path, f"{prefix}{entry.name}/")
            else:
                with contextlib.suppress(FileNotFoundError):
                    state = entry.stat()
                    yield f"{prefix}{entry.name}", Listed(state.st_size, state.st_mtime)
