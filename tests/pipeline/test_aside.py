"""What keeps others waiting goes first; what little waits for goes last and travels alone, so that it fills the time in which
nothing else is ready.
"""

import pytest

from kinetree.pipeline.planning.entry import Entry
from kinetree.pipeline.planning.ready import urgency
from kinetree.pipeline.planning.schedule import Schedule

LONG = '''"""A long way over all frames, and a note of each frame that only its end reads."""

from collections.abc import Mapping

from kinetree.pipeline.graph import Graph
from kinetree.pipeline.task import task
from kinetree.schemas.array import Artifact

from .toys import Points, Smooth, points, smooth, source


class Note(Artifact):
    """Of one frame."""

    text: str


class First(Artifact):
    """Of all frames."""

    count: int


class Second(Artifact):
    """Of the first."""

    count: int


class Third(Artifact):
    """Of the second."""

    count: int


class Page(Artifact):
    """Of all there is."""

    text: str


@task(over="frame")
def note(points: Points) -> Note:
    return Note(text="seen")


@task()
def first(smooth: Mapping[int, Smooth]) -> First:
    return First(count=len(smooth))


@task()
def second(first: First) -> Second:
    return Second(count=first.count)


@task()
def third(second: Second) -> Third:
    return Third(count=second.count)


@task()
def page(third: Third, note: Mapping[int, Note]) -> Page:
    return Page(text=f"{third.count} {len(note)}")


GRAPH = Graph.of((source, points, smooth, note, first, second, third, page))
'''


@pytest.fixture
def schedule(toys) -> Schedule:
    """The long way, nothing computed."""
    (toys.folder / toys.name / "long.py").write_text(LONG)
    toys.main = "long"
    return toys.pipeline().schedule()


def done(schedule: Schedule, parcel: list[Entry]) -> None:
    """The nodes of a parcel are computed, whatever they are."""
    for entry in parcel:
        schedule.complete(entry.node, f"{entry.label:0<40}"[:40], f"{entry.label:0<40}"[:40], None, ran=True)


def test_a_short_way_is_aside_and_the_long_one_is_not(schedule):
    assert schedule.graph.aside == {"note"}
    assert schedule.graph.until(["note"]).aside == set(), "alone, its way is the longest"


def test_nodes_aside_go_when_nothing_else_is_ready(schedule):
    sent = []
    for entry in schedule.ready():
        parcel = schedule.send(entry)
        sent.append([e.node.task for e in parcel])
        done(schedule, parcel)
    assert sent[:6] == [["points", "smooth"]] * 6
    assert sent[6:9] == [["first"], ["second"], ["third"]]
    assert sent[9:] == [["note"]] * 6 + [["page"]]


def test_what_there_is_once_goes_before_the_members_that_are_ready_too(toys):
    schedule = toys.pipeline().schedule()
    tasks = schedule.graph.tasks
    sooner = urgency(schedule.graph)
    once = {task.name for task in tasks if not task.over} - schedule.graph.aside
    members = {task.name for task in tasks if task.over and not task.is_chain} - schedule.graph.aside
    assert once
    assert members
    assert min(sooner[name] for name in once) > max(sooner[name] for name in members)
    assert [sooner[task.name] for task in tasks if task.name in members] == sorted(sooner[name] for name in members)
