"""Passes over the same tasks: what is read at the previous member of a dimension, and tasks that ask for their index."""

import json
import signal

import pytest

from kinetree.pipeline.inspection.draw import draw
from kinetree.pipeline.storage.gc import collect

NUMBERS = (10.0, 20.0, 30.0, 40.0, 50.0, 60.0)
FRAMES = range(6)


@pytest.fixture
def passing(toys):
    """The toys, with the graph of passes."""
    toys.main = "toy_passes"
    return toys


def refits(*passes, frames=FRAMES):
    return {f"refit[pass={p},frame={n}]" for p in passes for n in frames}


def by_hand(module, count):
    """Poses and stiffnesses by a loop over the plain functions."""
    smooth = {n: module.Smooth(value=number) for n, number in enumerate(NUMBERS)}
    refitted, learned = [], []
    for _ in range(count):
        before = refitted[-1] if refitted else {}
        learned.append(module.stiffness(tuple(smooth.values()), before))
        refitted.append({n: module.refit(smooth[n], learned[-1], before.get(n)) for n in smooth})
    poses = {n: module.pose(smooth[n], {p: row[n] for p, row in enumerate(refitted)}) for n in smooth}
    return learned, refitted, poses


@pytest.mark.parametrize("count", [0, 1, 3])
def test_passes_equal_a_loop_written_by_hand(passing, count):
    block = {"passes": {"count": count}}
    run = passing.run(**block)
    learned, refitted, poses = by_hand(passing.module, count)
    pipeline = passing.pipeline(**block)
    assert [pipeline.artifact("stiffness", **{"pass": p}) for p in range(count)] == learned
    assert [{n: pipeline.artifact("refit", **{"pass": p, "frame": n}) for n in FRAMES} for p in range(count)] == refitted
    assert {n: pipeline.artifact("pose", frame=n) for n in FRAMES} == poses
    assert poses[5].value == (60.0 if count == 0 else pytest.approx(60 * 1.1**count))
    assert run.counts.get("refit", 0) == 6 * count
    assert run.told["status"] == "done"


def test_second_run_of_passes_runs_nothing(passing):
    passing.run()
    passing.clear()
    assert passing.run().ran == set()
    assert passing.executions() == []
    assert passing.pipeline().plan().is_done


def test_one_more_pass_computes_that_pass_and_what_reads_it(passing):
    passing.run(until=("pose",))
    run = passing.run(until=("pose",), passes={"count": 4})
    assert run.ran == {"passes", "stiffness[pass=3]", *refits(3), *(f"pose[frame={n}]" for n in FRAMES)}
    assert passing.run(until=("pose",), passes={"count": 2}).ran == {"passes", *(f"pose[frame={n}]" for n in FRAMES)}


def test_a_changed_frame_goes_through_its_own_passes_alone_where_nothing_else_is_learned(passing):
    passing.run(until=("pose",))
    passing.write(25, start=2)
    run = passing.run(until=("pose",))
    whole = {"passes", *(f"stiffness[pass={p}]" for p in range(3))}
    one = {"points[frame=2]", "smooth[frame=2]"}
    assert run.ran == {*one, *whole}  # 25 is 20 when rough, as frame 1 is, whose passes are known; the greatest is the same
    passing.write(5, start=2)
    run = passing.run(until=("pose",))
    assert run.ran == {*one, *whole, *refits(0, 1, 2, frames=[2]), "pose[frame=2]"}


def test_a_changed_frame_goes_through_all_passes_where_another_stiffness_is_learned(passing):
    passing.run(until=("pose",))
    passing.write(80, start=5)
    run = passing.run(until=("pose",))
    assert run.counts["stiffness"] == 3
    assert run.counts["refit"] == 18
    assert run.counts["pose"] == 6


def test_plan_lists_the_passes_and_says_what_waits_for_the_pass_before(passing):
    (row,) = [t for t in passing.pipeline().plan().tasks if t.task == "refit"]
    assert row.unknown == ("passes",)
    passing.run(until=("passes", "smooth"))
    plan = passing.pipeline().plan()
    assert {n.node for n in plan.nodes if n.task == "refit"} == refits(0, 1, 2)
    assert plan["stiffness[pass=0]"].state == "stale"
    assert plan["stiffness[pass=1]"].waits == tuple(sorted(refits(0)))
    assert plan["refit[pass=1,frame=3]"].waits == ("refit[pass=0,frame=3]", "stiffness[pass=1]")
    assert plan["pose[frame=3]"].waits == tuple(f"refit[pass={p},frame=3]" for p in range(3))


def test_every_pass_reads_its_own_index_and_the_pass_before(passing):
    passing.run()

    def made_from(node):
        return set(passing.pipeline().lineage(node).predecessors(node))

    smooth = {f"smooth[frame={n}]" for n in FRAMES}
    assert made_from("stiffness[pass=0]") == smooth
    assert made_from("stiffness[pass=1]") == {*smooth, *refits(0)}
    assert made_from("refit[pass=0,frame=3]") == {"smooth[frame=3]", "stiffness[pass=0]"}
    assert made_from("refit[pass=2,frame=3]") == {"smooth[frame=3]", "stiffness[pass=2]", *refits(1, frames=[3])}
    assert made_from("pose[frame=3]") == {"smooth[frame=3]", *refits(0, 1, 2, frames=[3])}


def test_what_one_pass_alone_has_reads_the_pass_before_though_that_has_none(passing):
    passing.run()
    plan = passing.pipeline().plan()
    assert [n.node for n in plan.nodes if n.task == "checked"] == [f"checked[pass=1,check=0,frame={n}]" for n in FRAMES]
    made = [passing.pipeline().artifact("checked", **{"pass": 1, "check": 0, "frame": n}).value for n in FRAMES]
    assert made == [passing.pipeline().artifact("refit", **{"pass": 0, "frame": n}).value for n in FRAMES]


def test_members_of_a_gather_are_numbered_by_the_dimension_gathered(passing):
    passing.run(source={"frames": "1::2"})
    pipeline = passing.pipeline(source={"frames": "1::2"})
    assert pipeline.artifact("pose", frame=3).passes == (0, 1, 2)
    assert pipeline.artifact("stiffness", **{"pass": 1}).frames == (1, 3, 5)
    assert pipeline.artifact("stiffness", **{"pass": 0}).frames == ()


def test_until_one_task_of_a_ring_takes_in_the_others(passing):
    run = passing.run(until=("stiffness",))
    assert set(run.counts) == {"points", "smooth", "passes", "stiffness", "refit"}
    names = [t.name for t in passing.module.GRAPH.until(["refit"]).tasks]
    assert names == ["source", "points", "smooth", "passes", "stiffness", "refit"]


def test_a_forced_task_of_a_ring_runs_and_equal_data_stops_there(passing):
    passing.run()
    assert passing.run(force=("refit",)).ran == refits(0, 1, 2)


def test_a_failed_frame_stops_the_next_pass_and_its_own_pose_alone(passing):
    passing.flag("fail-refit-36")  # frame 2: 30 + 60 / 10, in the first pass
    run = passing.run(until=("pose",))
    assert run.heard.nodes("failed") == ["refit[pass=0,frame=2]"]
    assert refits(0) - {"refit[pass=0,frame=2]"} <= run.ran
    skipped = {"stiffness[pass=1]", "stiffness[pass=2]", *refits(1, 2), *(f"pose[frame={n}]" for n in FRAMES)}
    assert set(run.heard.nodes("skipped")) == skipped
    (passing.flags / "fail-refit-36").unlink()
    assert passing.run(until=("pose",)).ran == {"refit[pass=0,frame=2]", *skipped}


def test_an_interrupted_pass_goes_on_where_it_stopped(passing, tmp_path):
    passing.run(store=str(tmp_path / "calm"))
    passing.clear()
    passing.flag("wait-stiffness-66")
    main = passing.folder / passing.name / "__main__.py"
    main.write_text(main.read_text().replace("from .toys import", "from .toy_passes import"))
    process = passing.start("run", str(passing.yaml()), "--executor", "threads", "--quiet")
    passing.until((passing.flags / "waiting-stiffness-66").exists, "the second pass begins", process)
    process.send_signal(signal.SIGTERM)
    process.communicate(timeout=60)
    assert process.returncode == 130
    (passing.flags / "wait-stiffness-66").unlink()
    ran = passing.run().ran
    assert not ran & {"stiffness[pass=0]", *refits(0)}
    assert {"stiffness[pass=1]", *refits(1, 2)} <= ran
    assert passing.artifacts() == passing.artifacts(store=str(tmp_path / "calm"))


def test_passes_are_the_same_bytes_wherever_they_are_computed(passing, tmp_path):
    def artifacts_of(name, **compute):
        passing.run(store=str(tmp_path / name), compute={"executor": "sync", **compute})
        return passing.artifacts(store=str(tmp_path / name))

    expected = artifacts_of("sync")
    assert len(expected) == 6 * 6 + 1 + 3 + 2 * 18
    assert artifacts_of("threads", executor="threads", workers=2) == expected
    assert artifacts_of("processes", executor="processes", workers=2) == expected


def test_passes_survive_the_collection_of_garbage_and_are_told_apart(passing):
    first = passing.run().told["run"]
    passing.write(80, start=5)
    second = passing.run().told["run"]
    pipeline = passing.pipeline()
    changes = pipeline.diff(first, second)
    assert set(changes["begins"]) == {"source[frame=5]"}
    assert {"stiffness[pass=0]", *refits(0, 1, 2)} <= set(changes["changed"])
    freed = collect(pipeline.store)
    assert len(freed.runs) == 1
    assert len(freed.records) > 18
    assert passing.run().ran == set()


def test_what_is_read_at_the_previous_pass_is_drawn_apart(passing):
    graph = passing.module.GRAPH.networkx()
    assert graph.edges["refit", "stiffness"] == {"argument": "refit", "form": "mapping", "previous": True}
    assert graph.edges["refit", "refit"]["previous"]
    assert not graph.edges["stiffness", "refit"]["previous"]
    number = {node: f"n{k}" for k, node in enumerate(graph.nodes)}
    lines = draw(graph, "mermaid").splitlines()
    assert f"    {number['refit']} -.-> {number['stiffness']}" in lines
    assert f"    {number['stiffness']} --> {number['refit']}" in lines
    assert f"    {number['refit']} ==> {number['pose']}" in lines
    lines = draw(graph, "dot").splitlines()
    assert '    "refit" -> "stiffness" [style=dashed];' in lines
    assert '    "stiffness" -> "refit";' in lines
    edges = {(e["from"], e["to"]): e["previous"] for e in json.loads(draw(graph, "json"))["edges"]}
    assert edges["refit", "stiffness"]
    assert not edges["refit", "pose"]
    passing.run()
    nodes = passing.pipeline().graph(expanded=True)
    assert nodes.edges["refit[pass=0,frame=1]", "stiffness[pass=1]"]["previous"]


def test_a_traversal_of_passes_that_leaves_them_is_refused(passing):
    from kinetree.errors import GraphError

    passing.edit("return member - 1 if member else None", "return member - 1", "toy_passes.py")
    with pytest.raises(GraphError, match=r"\[pass=0\]: Passes puts stiffness\[pass=-1\] before it"):
        passing.run()


def test_tasks_that_ask_for_it_are_told_their_own_index(passing):
    passing.run(source={"frames": "1::2"})
    pipeline = passing.pipeline(source={"frames": "1::2"})
    for p in range(3):
        for n in (1, 3, 5):
            assert pipeline.artifact("numbered", **{"pass": p, "frame": n}).index == (p, n)


def test_equal_frames_are_one_computation_unless_their_task_asks_for_the_index(passing):
    passing.write(10, 10, 10, 10, 10, 10)
    run = passing.run(until=("still", "numbered"))
    plan = passing.pipeline().plan(until=["still", "numbered"])
    assert len({plan[f"still[frame={n}]"].key for n in FRAMES}) == 1
    assert len({plan[f"numbered[pass={p},frame={n}]"].key for p in range(3) for n in FRAMES}) == 18
    assert (run.counts["still"], run.counts["numbered"]) == (1, 18)


def test_why_says_that_a_task_asks_for_its_index_now(passing):
    passing.run(until=("still",))
    old, new = "def still(smooth: Smooth) -> Still:", "def still(smooth: Smooth, index: Index) -> Still:"
    passing.edit(old, new, "toy_passes.py")
    reasons = passing.pipeline().why("still[4]").reasons
    assert [r.kind for r in reasons] == ["code", "index"]
    assert str(reasons[1]) == "index: (none) → frame=4"
    assert passing.run(until=("still",)).counts["still"] == 6
    passing.edit(new, old, "toy_passes.py")
    assert passing.run(until=("still",)).ran == set()
