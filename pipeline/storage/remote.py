"""The user's files in a bucket: found by folder or pattern, and brought to where a task reads them.

    s3://bucket/folder/          what lies directly in a folder
    s3://bucket/folder/a_*.txt   what matches a pattern; ** stands for any number of folders
    s3://bucket/folder/a.txt     one object

A task reads a file at a path and knows no network. What it reads one of (`X`, not `tuple[X, ...]`) is brought before it runs:
fields marked `Location` that name an object name a copy of it then, which is gone afterwards. Like every other reader of
the user's files the task holds the bytes against the digest that was planned with. Credentials are those of the environment.
"""

import contextlib
import os
import re
import shutil
import tempfile
import weakref
from collections.abc import Callable, Iterator, Mapping, Sequence
from fnmatch import fnmatchcase
from functools import lru_cache
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any, TypeVar

from kinetree.errors import InputError, ServiceError, StoreError
from kinetree.schemas.array import Artifact

if TYPE_CHECKING:
    from kinetree.pipeline.storage.bucket import Bucket
    from kinetree.pipeline.storage.place import Listed

T = TypeVar("T")
SCHEME = "s3://"
ASKED_AT_ONCE = 16
"""Objects that are copied at a time where many are wanted."""
COPIES = 4
"""Copies that a process keeps for tasks that read one object in turn, such as all frames in one file."""


def is_remote(where: object) -> bool:
    """Whether a text is the address of an object, a folder or a pattern in a bucket."""
    return isinstance(where, str) and where.startswith(SCHEME)


def listed_files(where: str) -> "dict[str, Listed]":
    """What lies at a folder, a pattern or an address, by address, sorted; hidden files are passed over.

    raises : InputError where the service refuses or there is nothing
    """
    bucket, key = _bucket(where)
    magic = re.search(r"[*?\[]", key)
    if magic:
        folder = key[: magic.start()].rpartition("/")[0]
        listed = _asked(lambda: bucket.listed(folder))
        paths = {f"{folder}/{name}".lstrip("/"): entry for name, entry in listed.items()}
        there = {path: entry for path, entry in paths.items() if _matches(path.split("/"), key.split("/"))}
    else:
        folder = key.rstrip("/")
        single = _asked(lambda: bucket.look(key)) if key and not key.endswith("/") else None
        inside = {} if single is not None else _asked(lambda: bucket.children(folder))
        there = (
            {key: single} if single is not None else {f"{folder}/{name}".lstrip("/"): entry for name, entry in inside.items()}
        )
    named = {path: entry for path, entry in there.items() if not PurePosixPath(path).name.startswith(".")}
    if not named:
        raise InputError(f"{where}: there is nothing; a folder, a pattern or a file in the bucket is needed")
    return {f"{bucket.url}/{path}": entry for path, entry in sorted(named.items())}


def look(address: str) -> "Listed | None":
    """What the service says of one object now; None where there is none."""
    bucket, key = _bucket(address)
    return _asked(lambda: bucket.look(key))


@contextlib.contextmanager
def copied(address: str) -> Iterator[Path]:
    """A file of this machine with the bytes and the name of an object, gone after the block; raises InputError.

    What is raised in the block calls the copy by the object's address.
    """
    with _copies() as copies:
        yield copies.of(address)


@contextlib.contextmanager
def brought(values: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """What a task reads, where artifacts that stand for themselves name copies of the objects that they named."""
    with _copies() as copies:
        yield {name: _local(value, copies) if isinstance(value, Artifact) else value for name, value in values.items()}


class _Copy:
    """An object as a file; the file goes when nobody has the value any more."""

    def __init__(self, address: str) -> None:
        bucket, key = _bucket(address)
        data = _asked(lambda: bucket.get(key))
        if data is None:
            raise InputError(f"{address}: there is no such object any more; was it removed? Run again")
        folder = tempfile.mkdtemp(prefix="input-")
        weakref.finalize(self, shutil.rmtree, folder, ignore_errors=True)
        self.path = Path(folder) / (PurePosixPath(key).name or "object")
        try:
            self.path.write_bytes(data)
        except OSError as error:
            raise InputError(f"{address}: no copy of it can be made in {folder}: {error.strerror}") from None


class _Copies:
    """The copies that one block uses, by address."""

    def __init__(self) -> None:
        self.by_address: dict[str, _Copy] = {}

    def of(self, address: str) -> Path:
        """The copy of an object; raises InputError."""
        if address not in self.by_address:
            entry = look(address)
            if entry is None:
                raise InputError(f"{address}: there is no such object; was it removed? Run again")
            self.by_address[address] = _copy(address, entry.tag, entry.size, entry.modified)
        return self.by_address[address].path


@lru_cache(maxsize=COPIES)
def _copy(address: str, _tag: str, _size: int, _modified: float) -> _Copy:
    """A copy of an object in this state."""
    return _Copy(address)


@contextlib.contextmanager
def _copies() -> Iterator[_Copies]:
    copies = _Copies()
    try:
        yield copies
    except Exception as error:
        names = {f"{copy.path.parent}{os.sep}": f"{address.rpartition('/')[0]}/" for address, copy in copies.by_address.items()}
        error.args = tuple(_renamed(part, names) for part in error.args)
        raise


def _renamed(part: Any, names: Mapping[str, str]) -> Any:
    for folder, name in names.items() if isinstance(part, str) else ():
        part = part.replace(folder, name)
    return part


def _local(artifact: Artifact, copies: _Copies) -> Artifact:
    changed: dict[str, Any] = {}
    for field in type(artifact).location_fields():
        value = getattr(artifact, field)
        if is_remote(value):
            changed[field] = str(copies.of(value))
        elif isinstance(value, tuple) and any(map(is_remote, value)):
            changed[field] = tuple(str(copies.of(one)) if is_remote(one) else one for one in value)
    return artifact.model_copy(update=changed) if changed else artifact


def _bucket(address: str) -> "tuple[Bucket, str]":
    """The bucket of an address, and the key in it."""
    name, _, key = address.removeprefix(SCHEME).partition("/")
    return _opened(name), key


@lru_cache(maxsize=4)
def _opened(name: str) -> "Bucket":
    def opened() -> "Bucket":
        from kinetree.pipeline.storage.bucket import Bucket

        return Bucket(f"{SCHEME}{name}", name="input")

    return _asked(opened)


def _asked(question: Callable[[], T]) -> T:
    """An answer of the service; what is wrong with it is wrong with the input and not with a store."""
    try:
        return question()
    except ServiceError:
        raise
    except StoreError as error:
        raise InputError(str(error)) from None


def _matches(parts: Sequence[str], pattern: Sequence[str]) -> bool:
    """Whether a path matches a pattern part by part; ** matches any number of parts."""
    if not pattern:
        return not parts
    if pattern[0] == "**":
        return any(_matches(parts[n:], pattern[1:]) for n in range(len(parts) + 1))
    return bool(parts) and fnmatchcase(parts[0], pattern[0]) and _matches(parts[1:], pattern[1:])
