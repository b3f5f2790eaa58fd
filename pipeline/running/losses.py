"""What was stored and is not there any more: it is taken back, and who listens to the run hears of it."""

from kinetree.pipeline.planning.entry import DONE
from kinetree.pipeline.running import sight
from kinetree.pipeline.running.fates import beyond_repair
from kinetree.pipeline.running.jobs import Job
from kinetree.pipeline.storage.store import Store


def take_back_lost(job: Job, store: Store) -> bool:
    """What somebody removed from the store after it was seen there is to be computed again; True if there was any."""
    done = [e for e in job.schedule.entries.values() if e.state in DONE and not e.task.is_origin]
    lost = sight.missing(store, {(e.key or "", e.artifact or "") for e in done})
    for entry in done:
        if (entry.key, entry.artifact) in lost:
            job.schedule.lose(entry, "it is missing")
    tell_losses(job)
    return bool(lost)


def tell_losses(job: Job) -> None:
    """What could not be read while more of the graph was laid out, or was not there in the end."""
    for loss in job.schedule.losses():
        job.watch.damaged(loss.entry, loss.was, loss.what)
        if loss.skipped is not None:
            failed = beyond_repair(loss.entry.artifact or "", loss.what)
            job.watch.fail(loss.entry, failed, [job.schedule.entries[n] for n in loss.skipped])
