"""Fan-outs that depend on data, and chains along a traversal."""

import pytest

from kinetree.errors import GraphError
from kinetree.pipeline.planning.together import STRETCH
from kinetree.pipeline.running.launch import Launcher
from kinetree.pipeline.running.run import run

CHAIN = '''"""Frames without files, linked in a row."""

from collections.abc import Mapping

from kinetree.pipeline.storage.files import Files
from kinetree.pipeline.graph import Graph
from kinetree.pipeline.task import origin, task
from kinetree.schemas.array import Artifact, Params


class SourceParams(Params):
    """Nothing of interest."""

    input: str = ""
    """Not read."""


class Source(Artifact):
    """One frame."""

    number: int
    """Its number."""


class RowParams(Params):
    """Which end is first."""

    first: int = 0
    """Frame number."""


class Row(Artifact):
    """From one end to the other."""

    first: int
    """Where it starts."""

    def previous(self, member):
        return None if member == self.first else member - 1 if self.first == 0 else member + 1


class Link(Artifact):
    """The chain up to a frame."""

    length: int
    """Links."""
    number: int
    """The frame's."""


@origin(over="frame")
def source(params: SourceParams, files: Files) -> Mapping[int, Source]:
    return {n: Source(number=n) for n in range(2000)}


@task()
def row(source: tuple[Source, ...], params: RowParams) -> Row:
    return Row(first=params.first)


@task(over="frame", along=Row)
def link(source: Source, before: "Link | None") -> Link:
    return Link(length=before.length + 1 if before else 1, number=source.number)


GRAPH = Graph.of((source, row, link))
'''


def nodes(plan, task):
    return [n.node for n in plan.nodes if n.task == task]


def test_what_an_opener_opens_appears_when_it_has_run(toys):
    plan = toys.pipeline().plan()
    assert nodes(plan, "cones") == nodes(plan, "piece") == nodes(plan, "local") == []
    (row,) = [t for t in plan.tasks if t.task == "cones"]
    assert row.unknown == ("intervals",)
    assert not plan.is_done
    toys.run(until=("intervals",))
    plan = toys.pipeline().plan()
    assert nodes(plan, "cones") == [f"cones[interval={n}]" for n in range(3)]
    assert nodes(plan, "piece") == []
    assert nodes(plan, "local") == [f"local[interval={n // 2},frame={n}]" for n in range(6)]
    toys.run(until=("cones",))
    # the sums 30, 70 and 110 have odd tens: two cones each
    assert nodes(toys.pipeline().plan(), "piece") == [f"piece[interval={i},cone={c}]" for i in range(3) for c in range(2)]


def test_another_number_of_intervals_lays_out_other_nodes(toys):
    toys.run()
    toys.run(intervals={"length": 3})
    plan = toys.pipeline(intervals={"length": 3}).plan()
    assert nodes(plan, "cones") == ["cones[interval=0]", "cones[interval=1]"]
    # the sum 60 has even tens, the sum 150 odd ones
    assert nodes(plan, "piece") == ["piece[interval=0,cone=0]", "piece[interval=1,cone=0]", "piece[interval=1,cone=1]"]
    assert nodes(plan, "local") == [f"local[interval={n // 3},frame={n}]" for n in range(6)]
    assert plan.is_done


def test_a_task_over_intervals_gathers_the_frames_of_its_own(toys):
    toys.run()
    values = [toys.pipeline().artifact("cones", interval=n).value for n in range(3)]
    assert values == [30.0, 70.0, 110.0]
    reads = toys.pipeline().lineage("cones[1]").predecessors("cones[interval=1]")
    assert set(reads) == {"smooth[frame=2]", "smooth[frame=3]"}
    reads = toys.pipeline().lineage("local[interval=1,frame=3]").predecessors("local[interval=1,frame=3]")
    assert set(reads) == {"smooth[frame=3]", "cones[interval=1]"}


def test_a_second_pass_over_the_frames_reads_the_gather(toys):
    toys.run(until=("centred",))
    assert [toys.pipeline().artifact("centred", frame=n).value for n in range(6)] == [-25, -15, -5, 5, 15, 25]


def test_a_chain_goes_outwards_from_the_reference_to_both_sides(toys):
    toys.run(until=("track",))
    way = {n: toys.pipeline().artifact("track", frame=n).way for n in range(6)}
    assert way[2] == (-5.0,)
    assert way[1] == (-5.0, -15.0)
    assert way[0] == (-5.0, -15.0, -25.0)
    assert way[5] == (-5.0, 5.0, 15.0, 25.0)
    reads = toys.pipeline().lineage("track[4]").predecessors("track[frame=4]")
    assert set(reads) == {"centred[frame=4]", "track[frame=3]"}


def test_a_chain_over_selected_frames_goes_from_one_to_the_next_of_them(toys):
    toys.run(until=("track",), source={"frames": "::2"})
    assert toys.pipeline(source={"frames": "::2"}).artifact("track", frame=4).way == (0.0, 20.0)


def test_another_reference_reruns_the_chain_and_nothing_else(toys):
    toys.run()
    assert toys.run(order={"reference": 3}).counts == {"order": 1, "track": 6, "report": 1}


def test_a_broken_link_stops_its_side_of_the_chain_alone(toys):
    toys.flag("fail-track-5")
    run = toys.run(until=("track",))
    assert run.heard.nodes("failed") == ["track[frame=3]"]
    assert run.heard.nodes("skipped") == ["track[frame=4]", "track[frame=5]"]
    assert {"track[frame=0]", "track[frame=1]", "track[frame=2]"} <= run.ran


def test_a_traversal_that_goes_in_a_ring_is_refused(toys):
    toys.edit("if at == self.reference:\n            return None", "if at == self.reference:\n            return member + 1")
    with pytest.raises(GraphError, match=r"6 nodes wait for each other, track\[frame=0\] .* Order orders goes in a ring"):
        toys.run(until=("track",))
    assert toys.run(until=("centred",)).ran == set()


def test_a_traversal_that_leaves_the_sequence_is_refused(toys):
    toys.edit("if at == self.reference:\n            return None", "if at == self.reference:\n            return 99")
    with pytest.raises(GraphError, match=r"track\[frame=2\]: Order puts track\[frame=99\] before it"):
        toys.run(until=("track",))


def test_a_long_chain_needs_no_stack(toys):
    """Two thousand frames in a row, each of which reads the one before it, planned, run and found fresh."""
    (toys.folder / toys.name / "chain.py").write_text(CHAIN)
    toys.main = "chain"
    assert toys.run().counts == {"row": 1, "link": 2000}
    assert toys.pipeline().artifact("link", frame=1999).length == 2000
    assert toys.run().ran == set()


def sent_by_run(schedule):
    """The labels of every parcel of a run with one parcel out at a time, in the order in which they are sent."""
    from dask.local import SynchronousExecutor

    from kinetree.pipeline.running.events import Watch
    from kinetree.pipeline.running.execute import execute

    sent = []

    def submit(name, demand, url, steps, sight):
        sent.append((name.partition("-")[0], [step.label for step in steps]))
        return SynchronousExecutor().submit(execute, url, steps, sight)

    schedule.store.create()
    run(schedule, Launcher(submit, lambda: 1), Watch())
    return sent


def test_frames_travel_whole_and_the_deepest_go_first(toys):
    """With one parcel out at a time, a frame's nodes are sent together, not task by task."""
    sent = sent_by_run(toys.pipeline().schedule(until=["smooth"]))
    assert [labels for _, labels in sent] == [[f"points[frame={n}]", f"smooth[frame={n}]"] for n in range(6)]
    assert {name for name, _ in sent} == {"points+smooth"}


def test_what_is_made_of_a_frame_after_all_passes_travels_with_its_last_pass(toys):
    toys.main = "toy_passes"
    sent = [labels for name, labels in sent_by_run(toys.pipeline().schedule(until=["pose"])) if name.startswith("refit")]
    assert sent[:12] == [[f"refit[pass={p},frame={n}]"] for p in (0, 1) for n in range(6)]
    assert sent[12:] == [[f"refit[pass=2,frame={n}]", f"pose[frame={n}]"] for n in range(6)]


def test_each_side_of_a_chain_travels_by_itself_once_nothing_else_is_missing(toys):
    toys.run(until=("centred",))
    sent = [labels for name, labels in sent_by_run(toys.pipeline().schedule(until=["track"])) if name == "track"]
    assert sent == [["track[frame=2]"], ["track[frame=1]", "track[frame=0]"], [f"track[frame={n}]" for n in (3, 4, 5)]]


def test_a_long_chain_travels_in_stretches(toys):
    (toys.folder / toys.name / "chain.py").write_text(CHAIN.replace("range(2000)", "range(2 * 16 + 3)"))
    toys.main = "chain"
    sent = [labels for name, labels in sent_by_run(toys.pipeline().schedule()) if name == "link"]
    assert [len(labels) for labels in sent] == [STRETCH, STRETCH, 3]
    assert [label for labels in sent for label in labels] == [f"link[frame={n}]" for n in range(2 * STRETCH + 3)]


@pytest.mark.parametrize("more", [0, 1])
def test_a_chain_goes_first_and_takes_nothing_along(toys, more):
    """What reads a link can wait, the next link cannot; the last stretch may be one link."""
    read = '''

class Mark(Artifact):
    """Of a link."""

    number: int
    """The frame's."""


@task(over="frame")
def mark(link: Link) -> Mark:
    return Mark(number=link.number)


GRAPH = Graph.of((source, row, link, mark))
'''
    (toys.folder / toys.name / "chain.py").write_text(CHAIN.replace("range(2000)", f"range({2 * STRETCH + more})") + read)
    toys.main = "chain"
    sent = [labels for _, labels in sent_by_run(toys.pipeline().schedule())]
    frames = range(2 * STRETCH + more)
    links = [[f"link[frame={n}]" for n in frames[k : k + STRETCH]] for k in range(0, len(frames), STRETCH)]
    assert sent == [["row"], *links, *([f"mark[frame={n}]"] for n in frames)]


def test_a_task_may_be_set_by_the_block_of_another(toys):
    marked = '''

class Mark(Artifact):
    """What the block of the row says."""

    first: int
    """Frame number."""


@task(block="row")
def mark(link: tuple[Link, ...], params: RowParams) -> Mark:
    return Mark(first=params.first)


GRAPH = Graph.of((source, row, link, mark))
'''
    (toys.folder / toys.name / "chain.py").write_text(CHAIN.replace("range(2000)", "range(3)") + marked)
    toys.main = "chain"
    toys.run()
    assert "mark" not in toys.pipeline().config.params
    assert "mark" in toys.run(row={"first": 2}).counts
    assert toys.pipeline(row={"first": 2}).artifact("mark").first == 2


def test_of_the_block_of_another_a_task_sees_the_fields_of_its_own_params(toys):
    marked = '''

class Mark(Artifact):
    """What one parameter of the row says."""

    first: int
    """Frame number."""


@task(block="row")
def mark(source: tuple[Source, ...], params: StartParams) -> Mark:
    assert not hasattr(params, "label")
    return Mark(first=params.first)


GRAPH = Graph.of((source, row, link, mark))
'''
    start = "class RowParams(Params):"
    extended = '''class StartParams(Params):
    """Where it starts."""

    first: int = 0
    """Frame number."""


class RowParams(StartParams):
    """Which end is first, and what it is called."""

    label: str = ""
    """Not read."""'''
    before, _, after = CHAIN.replace("range(2000)", "range(3)").partition(start)
    text = before + extended + after.partition('"""Frame number."""')[2]
    (toys.folder / toys.name / "chain.py").write_text(text + marked)
    toys.main = "chain"
    toys.run()
    stale = lambda **row: {n.task for n in toys.pipeline(row=row).plan().nodes if n.state == "stale"}  # noqa: E731
    assert "row" in stale(label="second")
    assert "mark" not in stale(label="second")
    assert "mark" in stale(first=2)
