"""Schedules that one loop runs side by side: which of them sends next, and when another one is begun.

Every schedule that is open has an equal share of the parcels under way, so that a short one is done soon beside a long one;
within a schedule the deepest ready node goes first. Few are open at a time: another one is begun where workers would have
nothing to do.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Protocol

from kinetree.pipeline.planning.schedule import Schedule
from kinetree.pipeline.running.events import Watch
from kinetree.pipeline.running.memory import Needs

OPEN_AT_LEAST = 2
"""Schedules that are open where there are so many, although one alone has enough work for all workers."""


@dataclass(eq=False)
class Job:
    """One schedule under way, and who hears of it."""

    schedule: Schedule
    watch: Watch
    needs: Needs = field(default_factory=Needs)
    """How much memory its nodes need."""
    out: int = 0
    """Parcels under way, and nodes that wait for a parcel of any schedule or to be tried again."""

    @property
    def is_over(self) -> bool:
        """Whether nothing of it is under way and nothing can be sent."""
        return not self.out and self.schedule.deepest() is None

    @property
    def is_idle(self) -> bool:
        """Whether it needs no worker: everything is up to date."""
        return self.schedule.is_idle


class Jobs(Protocol):
    """Where a loop takes schedules from, and whom it tells that one is over."""

    def begin(self) -> Job | None:
        """The next one, which is open from now on; None where there is none left."""

    def end(self, job: Job) -> None:
        """Every node of it is done, failed or skipped."""

    def may_send(self) -> bool:
        """Whether parcels may still be sent; False lets those that are out come back and ends the loop."""


@dataclass
class Single:
    """One schedule alone."""

    job: Job
    _left: list[Job] = field(init=False)

    def __post_init__(self) -> None:
        self._left = [self.job]

    def begin(self) -> Job | None:
        """The one, once."""
        return self._left.pop() if self._left else None

    def end(self, job: Job) -> None:
        """Nobody waits for it."""

    def may_send(self) -> bool:
        """Always."""
        return True


def fairest(jobs: Sequence[Job]) -> Job | None:
    """Of those that have a ready node, one with the fewest parcels under way; of equals the one whose node is deepest."""
    ready = [(job.out, -depth, number) for number, job in enumerate(jobs) if (depth := job.schedule.deepest()) is not None]
    return jobs[min(ready)[2]] if ready else None
