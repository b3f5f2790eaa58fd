"""Tells a schedule, and who listens to it, what became of its nodes."""

from kinetree.pipeline.planning.entry import DONE, Entry
from kinetree.pipeline.running.execute import Result
from kinetree.pipeline.running.fates import beyond_repair, refusal
from kinetree.pipeline.running.jobs import Job
from kinetree.pipeline.running.losses import tell_losses


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
    tell_losses(job)


def _mend(job: Job, entry: Entry, result: Result) -> None:
    """An input could not be read: whoever made it makes it again, then this node runs."""
    redone = job.schedule.mend(entry.node, result.artifact, result.message)
    if redone is None:
        tell(job, entry, beyond_repair(result.artifact, result.message))
        return
    for maker, was in redone:
        job.watch.damaged(maker, was, result.message)
