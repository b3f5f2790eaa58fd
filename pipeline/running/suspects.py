"""Who is to blame where workers died with a parcel: the first node of it that has no record, and nobody else."""

from collections import Counter, deque
from dataclasses import dataclass, field

from kinetree.errors import LateNodeError, LostWorkerError
from kinetree.pipeline.node import Node
from kinetree.pipeline.planning.entry import DONE, Entry
from kinetree.pipeline.running.execute import Result
from kinetree.pipeline.running.jobs import Job
from kinetree.pipeline.storage.store import Store


@dataclass
class Suspects:
    """Nodes whose workers died or whose time was over; each is tried again, alone, when nothing else is out."""

    waiting: deque[tuple[Job, Entry]] = field(default_factory=deque)
    """Those that are to be tried again."""
    _losses: Counter[tuple[Job, Node]] = field(default_factory=Counter)
    _queued: set[tuple[Job, Node]] = field(default_factory=set)
    """Nodes that were lost on a worker before they began; where that happens again, it is counted."""

    def losses(self, job: Job, entry: Entry) -> int:
        """How often a node was lost, and may have been the cause."""
        return self._losses[job, entry.node]

    def lose(self, job: Job, suspect: Entry, behind: list[Entry], error: Exception, store: Store) -> bool:
        """Counts that a node was lost; True if it is tried again, False if it fails.

        behind : what travelled with it. Where the node has a record that does not count, because it is computed again on
                 request, nobody knows whether it was finished: the loss is counted for all that are not done
        """
        lost = job, suspect.node
        if not isinstance(error, LostWorkerError | LateNodeError):
            return False
        if isinstance(error, LostWorkerError) and not error.has_begun and lost not in self._queued:
            self._queued.add(lost)
            return True
        self._losses[lost] += 1
        if store.record(suspect.key or "") is not None:
            self._losses.update((job, entry.node) for entry in behind if entry is not suspect and entry.state not in DONE)
        return self._losses[lost] <= suspect.task.retries


def finished(job: Job, entry: Entry, store: Store) -> Result | None:
    """What a worker stored of a node before it died; None where it stored nothing, or that is not known."""
    store.place.names("records")  # a network file system remembers for a while that a file was not there
    schedule = job.schedule
    key, record, _ = schedule.freshness.judged(entry, schedule.entries)
    return None if record is None else Result("fresh", key, record.artifact, 0.0, record)
