"""What becomes of nodes that are not computed: lost, late, in a ring, beyond repair, computed by another, or refused."""

from kinetree.errors import (
    ClusterError,
    GraphError,
    KinetreeError,
    ReadOnlyStoreError,
    ServiceError,
    StoreError,
    StoreFullError,
)
from kinetree.pipeline.planning.entry import Entry
from kinetree.pipeline.planning.schedule import Schedule
from kinetree.pipeline.running.execute import Result


def refuse_to_wait_for(entry: Entry, limit: float, *, is_elsewhere: bool) -> None:
    """A node that has this process to itself and does not come back would keep all others waiting."""
    if entry.task.threads > 1 and not is_elsewhere:
        raise ClusterError(
            f"{entry.label} takes longer than the {limit:g} s that its task allows, and has this process to itself (@task("
            f"threads={entry.task.threads})), where it cannot be ended; run again on workers (--executor processes)"
        )


def refuse_rings(schedule: Schedule) -> None:
    """A traversal that some artifact orders in a ring leaves nodes that wait for themselves."""
    left = [entry for entry in schedule.entries.values() if entry.state == "waits"]
    if left:
        raise GraphError(
            f"{len(left)} nodes wait for each other, {left[0].label} ({left[0].task.where}) among them: the traversal that"
            f" {left[0].task.along.__name__ if left[0].task.along else 'an artifact above'} orders goes in a ring"
        )


def beyond_repair(artifact: str, what: str) -> Result:
    """The failure of a node whose input was computed again in vain."""
    cause = f"artifact {artifact[:12]} {what}, again after it was computed again; check the disk"
    return Result("failed", error="DamagedArtifactError", message=cause)


def twin(result: Result) -> Result:
    """What became of a node whose twin was computed: the same, without having run."""
    return Result("fresh", result.key, result.artifact, 0.0, result.record) if result.status == "ran" else result


def refusal(result: Result) -> KinetreeError:
    """The error with which a worker refused to go on, by its name."""
    kinds = {kind.__name__: kind for kind in (StoreError, StoreFullError, ReadOnlyStoreError, ServiceError)}
    return kinds.get(result.error, ClusterError)(result.message)
