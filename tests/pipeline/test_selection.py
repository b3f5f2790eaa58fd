"""Gathers among selected members: what lies outside the selection is in no key."""

import pytest

from kinetree.errors import GraphError, MissingWriterError
from kinetree.pipeline.graph import Graph
from kinetree.pipeline.task import task
from kinetree.schemas.array import Artifact

CHOSEN = '''"""A mean over chosen frames alone, which every frame reads, pass after pass."""

from collections.abc import Mapping
from typing import ClassVar

from kinetree.pipeline.graph import Graph
from kinetree.pipeline.task import Previous, task
from kinetree.schemas.array import Artifact, Params

from .toys import Smooth, Source, points, smooth, source


class ChosenParams(Params):
    """Which frames are learned from."""

    below: int = 100
    """Those with smaller numbers."""


class Chosen(Artifact):
    """The frames that are learned from."""

    selects: ClassVar[str] = "frame"
    frames: tuple[int, ...]
    """All frames."""
    below: int
    """Chosen are those below."""

    def selected(self):
        return [t for t in self.frames if t < self.below]


class Passes(Artifact):
    """Two passes over all frames."""

    opens: ClassVar[tuple[str, ...]] = ("pass", "pass/frame")
    orders: ClassVar[str] = "pass"
    frames: tuple[int, ...]
    """All frames."""

    def members(self, space, index):
        return (0, 1) if space == "pass" else self.frames

    def previous(self, member):
        return member - 1 if member else None


class Mean(Artifact):
    """Of the chosen frames."""

    value: float
    """The mean."""
    frames: tuple[int, ...]
    """Of which frames."""


class Apart(Artifact):
    """One frame."""

    value: float
    """Beside the mean."""


@task()
def chosen(source: Mapping[int, Source], params: ChosenParams) -> Chosen:
    return Chosen(frames=tuple(source), below=params.below)


@task()
def passes(source: Mapping[int, Source]) -> Passes:
    return Passes(frames=tuple(source))


@task(over="pass", along=Passes, among=Chosen)
def mean(smooth: Mapping[int, Smooth], apart: Previous[Mapping[int, "Apart"]]) -> Mean:
    values = [(apart or smooth)[t].value for t in smooth]
    return Mean(value=sum(values) / len(values), frames=tuple(smooth))


@task(over="pass/frame", along=Passes)
def apart(smooth: Smooth, mean: Mean, before: "Apart | None") -> Apart:
    return Apart(value=(before or smooth).value - mean.value)


GRAPH = Graph.of((source, points, smooth, chosen, passes, mean, apart))
'''


@pytest.fixture
def choosing(toys):
    """The toys, with the graph of a selection."""
    (toys.folder / toys.name / "chosen.py").write_text(CHOSEN)
    toys.main = "chosen"
    return toys


def test_a_task_gathers_the_selected_members_alone(choosing):
    choosing.run(chosen={"below": 4})
    pipeline = choosing.pipeline(chosen={"below": 4})
    assert [pipeline.artifact("mean", **{"pass": p}).frames for p in (0, 1)] == [(0, 1, 2, 3)] * 2
    assert pipeline.artifact("mean", **{"pass": 0}).value == 25.0
    assert [pipeline.artifact("apart", **{"pass": 1, "frame": n}).value for n in range(6)] == [-15, -5, 5, 15, 25, 35]
    assert set(pipeline.lineage("mean[0]").predecessors("mean[pass=0]")) == {f"smooth[frame={n}]" for n in range(4)}


def test_an_appended_frame_outside_the_selection_computes_itself_and_no_gather_among_it(choosing):
    choosing.run(chosen={"below": 4})
    before = choosing.artifacts(chosen={"below": 4})
    choosing.write(70, start=6)
    run = choosing.run(chosen={"below": 4})
    own = {"points[frame=6]", "smooth[frame=6]", "apart[pass=0,frame=6]", "apart[pass=1,frame=6]"}
    assert run.ran == own | {"chosen", "passes"}
    assert {n: a for n, a in choosing.artifacts(chosen={"below": 4}).items() if n in before and "[" in n} == {
        n: a for n, a in before.items() if "[" in n
    }


def test_another_selection_learns_again(choosing):
    choosing.run(chosen={"below": 4})
    run = choosing.run(chosen={"below": 5})
    assert run.counts == {"chosen": 1, "mean": 2, "apart": 12}


class Seed(Artifact):
    """Once."""


class Choice(Artifact):
    """Selects days."""

    selects = "day"


class Grain(Artifact):
    """Once."""


def test_what_selects_nothing_cannot_be_gathered_among():
    with pytest.raises(GraphError, match="is among Seed, which selects nothing"):

        @task(among=Seed)
        def grain(choice: Choice) -> Grain:
            return Grain()


def test_a_selection_that_nobody_writes_or_nothing_gathers_is_refused():
    @task()
    def seed() -> Seed:
        return Seed()

    @task()
    def choice(seed: Seed) -> Choice:
        return Choice()

    @task(among=Choice)
    def grain(seed: Seed) -> Grain:
        return Grain()

    with pytest.raises(MissingWriterError, match="the selection it gathers among is Choice"):
        Graph.of((seed, grain))
    with pytest.raises(GraphError, match="which selects day, but gathers over no day"):
        Graph.of((seed, choice, grain))
