"""Tells a schedule, and who listens to it, what became of its nodes."""

from kinetree.pipeline.planning.entry import DONE, Entry
from kinetree.pipeline.running import sight
from kinetree.pipeline.running.execute import Result
from kinetree.pipeline.running.fates import beyond_repair, refusal
from kinetree.pipeline.running.jobs import Job
from kinetree.pipeline.storage.store import Store


def tell(job: Job, entry: Entry, result: Result) -> None:
    """What became of one node that was sent; raises what a worker refused to go on for."""
    if result.status in ("ran", "fresh"):
        _complete(job, entry, result)
    elif result.status == "failed":
        skipped = job.schedule.fail(entry.node, result.message)
        job.watch.fail(entry, result, [job.schedule.entries[n] for n in skipped])
    elif result.status == "damaged":
        _mend(job, entry, result)
    elif result.status == "undone":
        job.schedule.put_back(entry.node)
    else:
        raise refusal(result)


def take_back_lost(job: Job, store: Store) -> bool:
    """What somebody removed from the store after it was seen there is to be computed again; True if there was any."""
    done = [e for e in job.schedule.entries.values() if e.state in DONE and not e.task.is_origin]
    lost = sight.missing(store, {(e.key or "", e.artifact or "") for e in done})
    for entry in done:
        if (entry.key, entry.artifact) in lost:
            job.schedule.lose(entry, "it is missing")
    _tell_losses(job)
    return bool(lost)


def _complete(job: Job, entry: Entry, result: Result) -> None:
    schedule = job.schedule
    if entry.state in DONE:
        return
    before = len(schedule.entries)
    fresh = schedule.complete(entry.node, result.key, result.artifact, result.record, ran=result.status == "ran")
    if len(schedule.entries) != before:
        job.watch.layout(schedule.entries.values())
    if result.record is not None:
        job.needs.learn(result.record)
    job.watch.finish(entry, result)
    job.watch.fresh(fresh)
    job.watch.skip(schedule.skipped_late())
    _tell_losses(job)


def _mend(job: Job, entry: Entry, result: Result) -> None:
    """An input could not be read: whoever made it makes it again, then this node runs."""
    redone = job.schedule.mend(entry.node, result.artifact, result.message)
    if redone is None:
        tell(job, entry, beyond_repair(result.artifact, result.message))
        return
    for maker, was in redone:
        job.watch.damaged(maker, was, result.message)


def _tell_losses(job: Job) -> None:
    """What could not be read while more of the graph was laid out, or was not there in the end."""
    for loss in job.schedule.losses():
        job.watch.damaged(loss.entry, loss.was, loss.what)
        if loss.skipped is not None:
            failed = beyond_repair(loss.entry.artifact or "", loss.what)
            job.watch.fail(loss.entry, failed, [job.schedule.entries[n] for n in loss.skipped])
