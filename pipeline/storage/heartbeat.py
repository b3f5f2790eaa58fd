"""Whether the process that writes a run still lives: told by the kernel on the same machine, by its heartbeat on another.

A process number is given to others after its process has died, so that alone it proves nothing. On one boot of one machine,
number and start time together are a process; in another container the numbers mean something else, so it counts as another
machine. From there only a heartbeat is seen: a small object that the run writes again and again into the store.
"""

import contextlib
import os
import socket
import threading
import time
import uuid
from collections.abc import Iterable, Iterator, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

from kinetree.errors import StoreError
from kinetree.pipeline.storage.store import Store

BEAT_SECONDS = 30.0
"""Between two heartbeats."""
LOST_SECONDS = 20 * BEAT_SECONDS
"""After this without a heartbeat a run counts as killed: longer than clocks differ and a busy file system hesitates."""
_STATE_FIELD, _START_FIELD = 0, 19
"""Of /proc/PID/stat, counted after the name in brackets."""


def identity() -> dict[str, Any]:
    """Which process this is, as a run's record tells it."""
    return {"host": socket.gethostname(), "machine": _machine(), "pid": os.getpid(), "process_start": _start(os.getpid())}


def lives(run: Mapping[str, Any], store: Store) -> bool:
    """Whether the process that began this run is still there, as far as can be known from here."""
    if is_here(run):
        return lives_here(run)
    beats, now = (float(run["epoch"]), store.place.modified(_path(run["name"]))), time.time()
    return has_beaten(beats, _clock_of(store) if max(beats) > now + LOST_SECONDS else now)


def has_beaten(beats: Iterable[float], now: float) -> bool:
    """Whether one of the beats is not too long ago; one that lies as far ahead comes from a wrong clock and is none."""
    return any(abs(now - beat) < LOST_SECONDS for beat in beats)


def _clock_of(store: Store) -> float:
    """What the clock of the store's place shows, by which heartbeats are dated; this machine's where nothing can be written."""
    probe = _path(f"clock-{uuid.uuid4().hex}")
    try:
        store.place.put(probe, b"")
        modified = store.place.modified(probe)
        store.place.remove(probe)
    except StoreError:
        return time.time()
    return modified


def is_here(process: Mapping[str, Any]) -> bool:
    """Whether a process that told its identity belongs to this boot of this machine, so that the kernel knows it."""
    return bool(process.get("machine") == _machine())


def lives_here(process: Mapping[str, Any]) -> bool:
    """Whether a process of this machine is still there."""
    start = _start(int(process["pid"]))
    return start is not None and start == process.get("process_start")


@contextlib.contextmanager
def beating(store: Store, name: str) -> Iterator[None]:
    """Writes a heartbeat for the run of that name until the block ends; what cannot be written is tried again."""
    over = threading.Event()

    def beat() -> None:
        while not over.wait(BEAT_SECONDS):
            with contextlib.suppress(StoreError):
                store.place.put(_path(name), b"alive")

    thread = threading.Thread(target=beat, name=f"heartbeat of {name}", daemon=True)
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()
        forget(store, name)


def forget(store: Store, name: str) -> None:
    """Removes the heartbeat of a run that is over."""
    if store.place.size(_path(name)) is not None:
        with contextlib.suppress(StoreError):
            store.place.remove(_path(name))


def _path(name: str) -> str:
    return f"runs/{name}.beat"


@lru_cache(maxsize=1)
def _machine() -> str:
    """The boot of this machine, and the space in which its process numbers are counted."""
    try:
        boot = Path("/proc/sys/kernel/random/boot_id").read_text(encoding="ascii").strip()
        return f"{boot} {Path('/proc/self/ns/pid').readlink()}"
    except OSError:
        return f"unknown, process {os.getpid()} began {time.time()}"  # no other process can be told from here


def _start(pid: int) -> int | None:
    """When a process began, in the kernel's ticks since boot; None where there is none or it has ended."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8", errors="replace").rpartition(")")[2].split()
    except OSError:
        return None
    return None if fields[_STATE_FIELD] in "ZX" else int(fields[_START_FIELD])
