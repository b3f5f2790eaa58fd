"""Several schedules in one loop: what they share, and that none of them holds up another."""

from dataclasses import dataclass, field

import pytest
from pipeline.conftest import Heard

from kinetree.pipeline.running.events import Watch
from kinetree.pipeline.running.jobs import Job
from kinetree.pipeline.running.launch import launcher
from kinetree.pipeline.running.run import run_all
from kinetree.pipeline.settings.config import Compute


@dataclass
class Line:
    """Jobs one after the other; notes which ended, and may be closed."""

    waiting: list[Job]
    ended: list[Job] = field(default_factory=list)
    begun: int = 0
    is_closed: bool = False

    def begin(self):
        self.begun += bool(self.waiting)
        return self.waiting.pop(0) if self.waiting else None

    def end(self, job):
        self.ended.append(job)

    def may_send(self):
        return not self.is_closed


@pytest.fixture
def take(toys):
    """Makes a job over frames of its own in the one store."""

    def made(name, *numbers):
        folder = toys.frames.parent / name
        folder.mkdir()
        for frame, number in enumerate(numbers):
            (folder / f"{frame:05d}.txt").write_text(f"{number}")
        pipeline = toys.pipeline(
            output=str(toys.output / name), store=str(toys.output / "store"), source={"input": str(folder)}
        )
        pipeline.store.create()
        heard = Heard()
        return Job(pipeline.schedule(), Watch((heard,)))

    return made


def run(line, executor="sync", workers=1):
    store = (*line.waiting, *line.ended)[0].schedule.store
    with launcher(Compute(executor=executor, workers=workers)) as launch:
        run_all(line, store, launch)


@pytest.mark.parametrize("executor", ["sync", "threads"])
def test_all_schedules_run_to_their_end(take, executor):
    line = Line([take("a", 10, 20), take("b", 30, 40, 50), take("c", 60, 70)])
    jobs = list(line.waiting)
    run(line, executor, workers=2)
    assert set(line.ended) == set(jobs)
    for job in jobs:
        assert {entry.state for entry in job.schedule.entries.values()} <= {"ran", "fresh"}


def test_a_short_one_is_not_held_up_by_a_long_one(take):
    long, short = take("long", *range(100, 130)), take("short", 10, 20)
    line = Line([long, short])
    run(line, "threads", workers=1)
    assert line.ended == [short, long]


def test_few_are_open_at_a_time(take):
    line = Line([take(name, number, number + 1) for number, name in enumerate("abcdef", 10)])
    open_at_once = []
    begin = line.begin
    line.begin = lambda: (open_at_once.append(line.begun - len(line.ended)), begin())[1]
    run(line)
    assert max(open_at_once) < 3


def test_a_node_that_two_schedules_have_is_computed_once(take, toys):
    run(Line([take("a", 10, 20), take("b", 10, 20)]), "threads", workers=2)
    ran = [name for name in toys.executions() if name.startswith("points")]  # what travels behind another may run in both
    assert len(ran) == len(set(ran))


def test_a_failure_stays_in_its_schedule(take, toys):
    toys.flag("fail-points-10")
    bad, good = take("bad", 10, 20), take("good", 30, 40)
    run(Line([bad, good]), "threads", workers=2)
    assert {entry.state for entry in good.schedule.entries.values()} <= {"ran", "fresh"}
    assert "failed" in {entry.state for entry in bad.schedule.entries.values()}


def test_a_line_that_closes_lets_what_is_out_come_back(take):
    line = Line([take("a", 10, 20), take("b", 30, 40)])
    line.may_send = lambda: line.begun < 2
    jobs = list(line.waiting)
    run(line)
    assert line.ended == []
    assert not any(entry.state == "running" for job in jobs for entry in job.schedule.entries.values())
