"""A toy graph whose tasks run pass after pass, and two tasks of which one asks for its index.

A pass learns one stiffness from what the pass before made of all frames, then fits every frame again from its own fit in the
pass before: a ring of tasks, cut open at the previous pass.
"""

from collections.abc import Mapping
from typing import ClassVar

from kinetree.pipeline.graph import Graph
from kinetree.pipeline.task import Previous, task
from kinetree.schemas.array import Artifact, Index, Params

from .toys import Smooth, Source, executed, points, smooth, source


class PassesParams(Params):
    """How often everything is fitted again."""

    count: int = 3
    """Passes."""


class Passes(Artifact):
    """The passes, each over all frames."""

    opens: ClassVar[tuple[str, ...]] = ("pass", "pass/frame", "pass/check", "pass/check/frame")
    orders: ClassVar[str] = "pass"
    count: int
    """How many."""
    frames: tuple[int, ...]
    """Frame numbers."""

    def members(self, space: str, index: Index) -> tuple[int, ...]:
        """The passes, or the frames of one; the second pass alone has a check."""
        if space == "pass/check":
            return (0,) if index == (1,) else ()
        return tuple(range(self.count)) if space == "pass" else self.frames

    def previous(self, member: int) -> int | None:
        """The pass before."""
        return member - 1 if member else None


class Stiffness(Artifact):
    """What one pass learned from all frames."""

    value: float
    """The greatest value of any frame."""
    frames: tuple[int, ...]
    """Frames whose refit it learned from."""


class Refit(Artifact):
    """One frame in one pass."""

    value: float
    """What became of it."""


class Checked(Artifact):
    """One frame before a pass that checks."""

    value: float
    """The refit's value in the pass before."""


class Pose(Artifact):
    """One frame after all passes."""

    value: float
    """The last refit's value; the frame's own where there was none."""
    passes: tuple[int, ...]
    """The passes it went through."""


class Still(Artifact):
    """A frame that does not know which it is."""

    value: float
    """The frame's value."""


class Numbered(Artifact):
    """A frame that knows which it is, in which pass."""

    index: tuple[int, ...]
    """Pass and frame."""


@task()
def passes(source: Mapping[int, Source], params: PassesParams) -> Passes:
    """Says how often."""
    executed("passes", params.count)
    return Passes(count=params.count, frames=tuple(source))


@task(over="pass", along=Passes)
def stiffness(smooth: tuple[Smooth, ...], refit: Previous[Mapping[int, Refit]]) -> Stiffness:
    """Learns from the pass before, at first from the frames as they are."""
    value = max(x.value for x in (*refit.values(), *smooth))
    executed("stiffness", value)
    return Stiffness(value=value, frames=tuple(refit))


@task(over="pass/frame", along=Passes)
def refit(smooth: Smooth, stiffness: Stiffness, before: Refit | None) -> Refit:
    """Fits a frame again from the pass before."""
    value = (before or smooth).value + stiffness.value / 10
    executed("refit", value)
    return Refit(value=value)


@task(over="pass/check/frame", along=Passes)
def checked(refit: Refit | None) -> Checked:
    """Looks at what the pass before made of a frame."""
    value = -1.0 if refit is None else refit.value
    executed("checked", value)
    return Checked(value=value)


@task(over="frame")
def pose(smooth: Smooth, refit: Mapping[int, Refit]) -> Pose:
    """Takes the last pass."""
    executed("pose", len(refit))
    return Pose(value=refit[max(refit)].value if refit else smooth.value, passes=tuple(refit))


@task(over="frame")
def still(smooth: Smooth) -> Still:
    """Looks at a frame."""
    executed("still", smooth.value)
    return Still(value=smooth.value)


@task(over="pass/frame")
def numbered(smooth: Smooth, index: Index) -> Numbered:
    """Looks at a frame and at which it is."""
    executed("numbered", index[-1])
    return Numbered(index=index)


TASKS = (source, points, smooth, refit, stiffness, passes, pose, checked, still, numbered)
GRAPH = Graph.of(TASKS)
