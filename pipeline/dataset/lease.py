"""Leases on output folders, so that two processes never do the same work at once.

A lease is a file in the folder that names its holder. The holder touches it again and again; one whose holder has died, here
or, as far as can be seen, on another machine, belongs to whoever asks next. Looking and taking are one step under the
kernel's lock of the file, which is held for that moment alone.
"""

import contextlib
import fcntl
import json
import os
import secrets
import threading
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from kinetree.errors import StoreError
from kinetree.pipeline.storage.heartbeat import BEAT_SECONDS, has_beaten, identity, is_here, lives_here

LEASE = ".lease"
"""Name of the file in the folder."""
PATIENCE = 0.2
"""Seconds between two tries to take a lease that another holds."""


@dataclass
class Leases:
    """The leases that this process holds; a context that keeps them alive and gives all back at its end."""

    _held: dict[Path, str] = field(default_factory=dict)
    _over: threading.Event = field(default_factory=threading.Event)
    _thread: threading.Thread | None = None

    def __enter__(self) -> "Leases":
        self._thread = threading.Thread(target=self._beat, name="leases", daemon=True)
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._over.set()
        if self._thread is not None:
            self._thread.join()
        for folder in list(self._held):
            self.give_back(folder)

    def take(self, folder: Path) -> bool:
        """Takes the lease on a folder, which is made where it is not there; False where a living process holds it.

        raises : StoreError where the folder cannot be written
        """
        nonce = secrets.token_hex(8)
        with _locked(folder) as file:
            if _is_held(file):
                return False
            os.ftruncate(file, 0)
            os.pwrite(file, json.dumps({**identity(), "nonce": nonce, "epoch": time.time()}).encode(), 0)
        self._held[folder] = nonce
        return True

    def wait_for(self, folder: Path, seconds: float) -> bool:
        """Takes the lease as soon as it is free; False where it was not within so many seconds."""
        until = time.monotonic() + seconds
        while not self.take(folder):
            if time.monotonic() > until:
                return False
            time.sleep(PATIENCE)
        return True

    def give_back(self, folder: Path) -> None:
        """Ends the lease on a folder; nothing happens where it is not held."""
        nonce = self._held.pop(folder, None)
        if nonce is None or not folder.is_dir():
            return
        with contextlib.suppress(StoreError, OSError), _locked(folder) as file:
            if _read(file).get("nonce") == nonce:
                (folder / LEASE).unlink(missing_ok=True)

    def _beat(self) -> None:
        while not self._over.wait(BEAT_SECONDS):
            for folder in list(self._held):
                with contextlib.suppress(OSError):
                    os.utime(folder / LEASE)


def holder(folder: Path) -> Mapping[str, Any] | None:
    """The living process that holds the lease on a folder, as host and pid; None where nobody does."""
    try:
        file = os.open(folder / LEASE, os.O_RDONLY)
    except OSError:
        return None
    try:
        return _read(file) if _is_held(file) else None
    finally:
        os.close(file)


def _is_held(file: int) -> bool:
    content = _read(file)
    if not content:
        return False
    try:
        if is_here(content):
            return lives_here(content)
        return has_beaten((float(content.get("epoch", 0.0)), os.fstat(file).st_mtime), time.time())
    except (KeyError, TypeError, ValueError):  # no lease of ours
        return False


def _read(file: int) -> dict[str, Any]:
    try:
        content = json.loads(os.pread(file, 4096, 0) or b"{}")
    except ValueError:
        return {}
    return content if isinstance(content, dict) else {}


@contextlib.contextmanager
def _locked(folder: Path) -> Iterator[int]:
    """The open file of a folder's lease, locked; made where it is not there."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        while True:
            file = os.open(folder / LEASE, os.O_RDWR | os.O_CREAT, 0o666)
            with contextlib.suppress(OSError):  # a file system without locks: the file's content alone decides
                fcntl.flock(file, fcntl.LOCK_EX)
            if _is_same(file, folder / LEASE):
                break
            os.close(file)  # its holder gave it back while this process waited for the lock
    except OSError as error:
        raise StoreError(
            f"output folder {folder}: cannot be written: {error.strerror}; check its permissions or name another folder"
        ) from error
    try:
        yield file
    finally:
        os.close(file)


def _is_same(file: int, path: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(file), path.stat())
    except FileNotFoundError:
        return False
