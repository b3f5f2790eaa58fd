"""Laws of the schedule: it alone changes its entries, and what a run tells it leaves no node where it cannot go on."""

import ast
from dataclasses import fields
from pathlib import Path

import pytest

from kinetree.errors import StoreError
from kinetree.pipeline.planning import schedule as module
from kinetree.pipeline.planning.damage import MENDS
from kinetree.pipeline.planning.entry import Entry
from kinetree.pipeline.planning.schedule import Schedule

HOME = Path(str(module.__file__))
DEPENDENTS = HOME.with_name("dependents.py")


def changed(path: Path) -> set[str]:
    """Attributes of something other than `self` that a file assigns, or to whose items it assigns."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text())):
        targets = node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", None)]
        each = [t for target in targets for t in (target.elts if isinstance(target, ast.Tuple) else [target])]
        owned = [t.value if isinstance(t, ast.Subscript) else t for t in each]
        attributes = [t for t in owned if isinstance(t, ast.Attribute)]
        names |= {t.attr for t in attributes if not (isinstance(t.value, ast.Name) and t.value.id == "self")}
    return names


def test_nobody_else_changes_the_entries_of_a_schedule():
    names = {field.name for field in fields(Entry)}
    assert {"state", "key", "artifact", "damaged"} <= changed(HOME) & names
    assert changed(DEPENDENTS) & names == {"state", "cause", "waits"}, "which a schedule has of its own"
    for path in HOME.parent.glob("*.py"):
        assert path in (HOME, DEPENDENTS) or not changed(path) & names, path.name


@pytest.fixture
def schedule(toys):
    """The toys as they are when frame 0 was read and its points are being made rough."""
    toys.run(until=("points",))
    return toys.pipeline().schedule(until=["smooth"])


def of(schedule, task, frame=0):
    return next(e for e in schedule.entries.values() if (e.node.task, e.node.at) == (task, (frame,)))


def test_a_lost_input_is_made_again_before_its_reader_runs(schedule):
    (smooth,) = schedule.send(next(schedule.ready()))
    points = of(schedule, "points")
    assert (smooth.label, smooth.state, points.state) == ("smooth[frame=0]", "running", "fresh")
    assert schedule.mend(smooth.node, str(points.artifact), "lost bytes") == [(points, "fresh")]
    assert (smooth.state, smooth.waits, points.state) == ("waits", {points.node}, "stale")
    assert [str(r) for r in points.reasons] == ["artifact: lost bytes"]
    assert points.node in [e.node for e in schedule.ready()]


def test_an_input_that_is_whole_again_is_not_thrown_away(schedule):
    (smooth,) = schedule.send(next(schedule.ready()))
    points = of(schedule, "points")
    schedule.mend(smooth.node, str(points.artifact), "lost bytes")
    schedule.send(points)
    assert points.damaged is None
    assert schedule.store.holds(points.record)


def test_a_reader_that_began_before_its_input_was_made_again_reads_it_again(schedule):
    (smooth,) = schedule.send(next(schedule.ready()))
    points = of(schedule, "points")
    schedule.mend(smooth.node, str(points.artifact), "lost bytes")
    schedule.complete(points.node, str(points.key), str(points.artifact), points.record, ran=True)
    schedule.send(next(schedule.ready()))
    assert schedule.mend(smooth.node, str(points.artifact), "lost bytes") == []
    assert (smooth.state, points.state, points.redone) == ("stale", "ran", 1)
    assert smooth.node in [e.node for e in schedule.ready()]
    assert schedule.mend(smooth.node, str(points.artifact), "lost bytes") == [(points, "ran")], "not believed twice"


def test_after_several_rounds_nothing_more_is_tried(schedule):
    (smooth,) = schedule.send(next(schedule.ready()))
    points = of(schedule, "points")
    for _ in range(MENDS + 1):  # once it is found whole instead
        assert schedule.mend(smooth.node, str(points.artifact), "lost bytes") is not None
        schedule.complete(points.node, str(points.key), str(points.artifact), points.record, ran=True)
    state = (smooth.state, points.state)
    assert schedule.mend(smooth.node, str(points.artifact), "lost bytes") is None
    assert (smooth.state, points.state) == state


def test_an_input_that_no_node_makes_is_refused_in_words(schedule):
    (smooth,) = schedule.send(next(schedule.ready()))
    with pytest.raises(StoreError, match=r"^smooth\[frame=0\]: artifact 0123456789ab lost bytes and nothing here makes it$"):
        schedule.mend(smooth.node, "0123456789abcdef", "lost bytes")
    assert smooth.state == "running"


def test_a_node_that_was_not_computed_waits_again_unless_it_is_skipped(toys):
    schedule = toys.pipeline().schedule(until=["smooth"])
    points, smooth = schedule.send(next(schedule.ready()))
    schedule.put_back(smooth.node)
    assert (smooth.state, smooth.waits) == ("waits", {points.node})
    assert schedule.fail(points.node, "broken") == [smooth.node]
    schedule.put_back(smooth.node)
    assert (smooth.state, smooth.cause) == ("skipped", "points[frame=0]")


def test_twice_the_members_are_laid_out_with_twice_the_questions(toys, monkeypatch):
    """What a node gathers below its own index is looked for there, and not among all."""

    def questions(frames):
        toys.write(*range(10, 10 * frames + 10, 10))
        assert toys.run(intervals={"length": 1}).told["status"] == "done"
        asked = []
        ask = Schedule._ask
        with monkeypatch.context() as patch:
            patch.setattr(Schedule, "_ask", lambda self, *question: asked.append(question) or ask(self, *question))
            toys.pipeline(intervals={"length": 1}).schedule()
        return len(asked)

    few = questions(8)
    assert questions(16) <= 2.2 * few
