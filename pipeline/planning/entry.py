"""One node of a schedule: its state, what it reads, and what is known of its result."""

from dataclasses import dataclass, field
from typing import Literal

from kinetree.pipeline.graph import AnyTask
from kinetree.pipeline.node import Node
from kinetree.pipeline.planning.reason import Reason
from kinetree.pipeline.signature import Argument
from kinetree.pipeline.storage.store import Record

State = Literal["waits", "stale", "running", "fresh", "ran", "failed", "skipped"]
DONE: tuple[State, ...] = ("fresh", "ran")


@dataclass
class Entry:
    """One node of the schedule and what is known of it."""

    node: Node
    task: AnyTask
    label: str
    state: State = "waits"
    inputs: tuple[tuple[Argument, tuple[Node, ...]], ...] | None = None
    """Per argument the nodes it reads; None while the members of a fan-out are not known."""
    waits: set[Node] = field(default_factory=set)
    reasons: tuple[Reason, ...] = ()
    key: str | None = None
    artifact: str | None = None
    record: Record | None = None
    damaged: str | None = None
    """Digest of an artifact that was found damaged and has to go before it is made again."""
    redone: int = 0
    """How often its artifact was damaged and had to be computed again."""
    is_late: bool = False
    """Whether it found an input damaged that had been made again by then."""
    cause: str = ""
    """What failed, for a failed node; which node failed, for a skipped one."""


@dataclass(frozen=True)
class Loss:
    """An artifact that a run or a layout found missing or damaged."""

    entry: Entry
    was: State
    what: str
    skipped: tuple[Node, ...] | None
    """What is skipped where its node failed for good; None where the node runs again."""
