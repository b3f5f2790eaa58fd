"""Peak memory of one piece of work in this process, and how much a node will need.

Linux can reset a process's high-water mark, so that the peak is the node's own; elsewhere the mark is the process's since
it started. Where several nodes run as threads of one process they share the number.
"""

import contextlib
import resource
import sys
import threading
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from kinetree.pipeline.graph import AnyTask
from kinetree.pipeline.storage.records import Record

_STATUS = Path("/proc/self/status")
_CLEAR = Path("/proc/self/clear_refs")


@dataclass
class Peak:
    """What one piece of work took."""

    process: int = 0
    """Bytes of resident memory of the process at the high-water mark."""
    own: int = 0
    """Bytes by which the process grew at most; 0 where other work ran beside it, and whose they were cannot be said."""


class _Running:
    """How many pieces of work are measured in this process now, and how many ever began."""

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.now = self.ever = 0


_running = _Running()


@contextlib.contextmanager
def measured() -> Iterator[Peak]:
    """Measures the block: what it took is known when it ends."""
    with _running.lock:
        beside = _running.now
        _running.now += 1
        _running.ever += 1
        ever = _running.ever
    with contextlib.suppress(OSError):
        _CLEAR.write_text("5")  # a new high-water mark, where the system can
    peak, before = Peak(), _bytes("VmRSS:")
    try:
        yield peak
    finally:
        peak.process = _bytes("VmHWM:")
        with _running.lock:
            _running.now -= 1
            is_alone = not beside and ever == _running.ever
        peak.own = max(0, peak.process - before) if is_alone and before else 0


def _bytes(name: str) -> int:
    """One of the kernel's figures of this process; where it tells none, the high-water mark since it started, or nothing."""
    with contextlib.suppress(OSError):
        for line in _STATUS.read_text().splitlines():
            if line.startswith(name):
                return int(line.split()[1]) * 1024
    if name != "VmHWM:":
        return 0
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak if sys.platform == "darwin" else peak * 1024


@dataclass
class Needs:
    """How many bytes nodes need: as their task declares, or else the most that a node of it was measured to need."""

    _measured: dict[str, int] = field(default_factory=dict)

    @staticmethod
    def of(records: Iterable[Record]) -> "Needs":
        """From the records of earlier runs."""
        needs = Needs()
        for record in records:
            needs.learn(record)
        return needs

    def learn(self, record: Record) -> None:
        """One node was computed."""
        self._measured[record.task] = max(record.own_bytes, self._measured.get(record.task, 0))

    def bytes(self, tasks: Iterable[AnyTask]) -> int:
        """For nodes of these tasks one after the other; 0 where nothing is known."""
        return max(self._measured.get(t.name, 0) if t.memory is None else t.memory for t in tasks)
