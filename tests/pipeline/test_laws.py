"""The laws of the loom: what runs again after what, counted node by node, and never anything else."""

import json
import os
import shutil

import networkx as nx
import pytest

TASKS = {"points", "smooth", "total", "centred", "intervals", "cones", "piece", "local", "order", "track", "report"}
ECHO = '''"""A task in a module of its own, with numerics of its own."""

from kinetree.pipeline.graph import Graph
from kinetree.pipeline.task import task
from kinetree.schemas.array import Artifact

from .loud import loud
from .toys import TASKS, Smooth


class Echo(Artifact):
    """An echo."""

    value: float
    """How loud."""


@task(over="frame")
def echo(smooth: Smooth) -> Echo:
    """Echoes."""
    return Echo(value=loud(smooth.value))


GRAPH = Graph.of((*TASKS, echo))
'''
LOUD = '''def loud(value):
    """Louder."""
    # by how much
    return 2.0 * value
'''


def frames(task, *numbers):
    return {f"{task}[frame={n}]" for n in numbers}


def test_first_run_computes_every_node_once(toys):
    run = toys.run()
    assert run.told["status"] == "done"
    assert set(run.counts) == TASKS
    assert run.counts["points"] == 6
    assert run.counts["local"] == 6
    assert sorted(toys.executions()) == sorted(set(toys.executions()))


def test_second_run_runs_nothing(toys):
    toys.run()
    toys.clear()
    again = toys.run()
    assert again.ran == set()
    assert toys.executions() == []
    assert again.told["nodes"] == {"ran": 0, "fresh": 43, "failed": 0, "skipped": 0}
    assert toys.pipeline().plan().is_done


def test_a_new_process_finds_everything_fresh(toys):
    toys.run()
    toys.clear()
    done = toys.command("run", str(toys.yaml()), "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["nodes"]["ran"] == 0
    assert toys.executions() == []


def test_a_changed_parameter_reruns_what_it_reaches(toys):
    toys.run()
    run = toys.run(intervals={"length": 3})
    assert run.counts == {"intervals": 1, "cones": 2, "piece": 2, "local": 6, "report": 1}


def test_whatever_a_parameter_reaches_runs_and_nothing_else(toys):
    toys.run()
    graph = toys.pipeline().tasks.networkx()
    # edges that fan out are not arguments: cones are laid out by intervals, tracks follow the order
    graph.add_edges_from([("intervals", "cones"), ("order", "track")])
    run = toys.run(points={"scale": 1.3})
    assert {n.partition("[")[0] for n in run.ran} <= {"points", *nx.descendants(graph, "points")}
    assert run.counts["points"] == run.counts["smooth"] == run.counts["centred"] == run.counts["track"] == 6


def test_equal_data_cuts_off_what_lies_below(toys):
    toys.run()
    run = toys.run(smooth={"grain": 5.0})
    assert run.ran == frames("smooth", *range(6))
    assert run.told["nodes"]["fresh"] == 37


def test_only_frames_whose_data_changed_go_on(toys):
    toys.run(until=("local",))
    run = toys.run(smooth={"grain": 20.0}, until=("local",))
    # 10, 30 and 50 become 0, 20 and 40, so every interval of two frames has changed, and both its frames with it
    assert run.counts == {"smooth": 6, "intervals": 1, "cones": 3, "local": 6}
    run = toys.run(points={"scale": 1.05}, until=("local",))
    # of 10.5, 21, …, 63 the multiples of ten below are what they were
    assert run.counts == {"points": 6, "smooth": 6}


def test_going_back_to_old_parameters_runs_nothing(toys):
    toys.run()
    toys.run(intervals={"length": 3})
    assert toys.run().ran == set()


def test_editing_comments_and_docstrings_reruns_nothing(toys):
    toys.run()
    toys.edit('"""Forgets the details."""', '"""Forgets nearly all."""\n    # a comment')
    toys.edit('"""The nearest multiple of `grain` at or below `value`."""', '"""Rounds down."""', "toy_sums.py")
    toys.edit('    """Multiples of this remain."""', '    """Only multiples of this remain."""')
    assert toys.run().ran == set()


def test_editing_a_formula_reruns_its_task_and_names_the_definition(toys):
    toys.run()
    toys.edit("return value // grain * grain", "return grain * (value // grain)", "toy_sums.py")
    plan = toys.pipeline().plan()
    assert str(plan["smooth[frame=3]"]) == f"smooth[frame=3]: stale (code: {toys.name}.toy_sums:rough)"
    assert str(plan["points[frame=3]"]) == "points[frame=3]: fresh"
    assert toys.run().ran == frames("smooth", *range(6))
    assert toys.run().ran == set()


def test_editing_what_no_task_can_reach_reruns_nothing(toys):
    toys.run()
    toys.edit("def parity", "def spare(value: float) -> float:\n    return value\n\n\ndef parity", "toy_sums.py")
    toys.edit("return value\n", "return 2 * value\n", "toy_sums.py")
    assert toys.run().ran == set()


def test_editing_a_formula_leaves_tasks_of_other_modules_alone(toys):
    (toys.folder / toys.name / "echo.py").write_text(ECHO)
    (toys.folder / toys.name / "loud.py").write_text(LOUD)
    toys.main = "echo"
    assert toys.run().counts["echo"] == 6
    toys.edit("# by how much", "# not too much", "loud.py")
    assert toys.run().ran == set()
    toys.edit("2.0 * value", "3.0 * value", "loud.py")
    assert [str(r) for r in toys.pipeline().plan()["echo[frame=0]"].reasons] == [f"code: {toys.name}.loud:loud"]
    assert toys.run().ran == frames("echo", *range(6))


def test_replacing_a_file_reruns_its_frame_and_what_truly_changed(toys):
    toys.run()
    toys.write(33, start=2)
    assert toys.run().ran == frames("points", 2) | frames("smooth", 2)
    toys.write(88, start=2)
    run = toys.run()
    assert {n for n in run.ran if n.startswith(("points", "smooth"))} == frames("points", 2) | frames("smooth", 2)
    # the sum is another, the number of frames is not: what lies in other intervals stays
    assert {n for n in run.ran if n.startswith(("cones", "local"))} == {
        "cones[interval=1]",
        "local[interval=1,frame=2]",
        "local[interval=1,frame=3]",
    }
    assert {"total", "order", "intervals", "report"} <= run.ran


def test_touching_a_file_reruns_nothing(toys):
    toys.run()
    for file in toys.frames.iterdir():
        os.utime(file, (1, 1))
    assert toys.run().ran == set()


def test_writing_the_same_bytes_again_reruns_nothing(toys):
    toys.run()
    toys.write(10, 20, 30, 40, 50, 60)
    assert toys.run().ran == set()


def test_moving_and_renaming_the_input_reruns_nothing(toys, tmp_path):
    toys.run()
    before = toys.artifacts()
    toys.frames = toys.frames.rename(tmp_path / "elsewhere")
    for file in sorted(toys.frames.iterdir()):
        file.rename(file.with_name(f"scan_{file.name}"))
    assert toys.run().ran == set()
    assert toys.artifacts() == before


def test_where_a_file_lies_is_no_part_of_what_it_is(toys):
    from kinetree.pipeline.identity.key import artifact_digest

    source = toys.module.Source
    assert artifact_digest(source(content="a", path="/here")) == artifact_digest(source(content="a", path="/there"))
    assert artifact_digest(source(content="a", path="/here")) != artifact_digest(source(content="b", path="/here"))


def test_appended_frames_compute_themselves_and_what_depends_on_them(toys):
    toys.run()
    toys.write(70, start=6)
    run = toys.run()
    assert {n for n in run.ran if n.startswith(("points", "smooth"))} == frames("points", 6) | frames("smooth", 6)
    assert {n for n in run.ran if n.startswith(("cones", "local"))} == {"cones[interval=3]", "local[interval=3,frame=6]"}
    # the mean has moved, so every frame is seen anew
    assert run.counts["centred"] == run.counts["track"] == 7


def test_a_removed_frame_leaves_the_others_alone(toys):
    toys.run()
    toys.write(70, start=6)
    toys.run()
    (toys.frames / "00006.txt").unlink()
    assert toys.run().ran == set()


def test_frames_selected_of_a_sequence_are_the_same_frames(toys):
    toys.run()
    run = toys.run(source={"frames": "1:5:2"})
    assert run.counts.get("points") is None
    assert run.counts.get("smooth") is None
    assert run.counts["centred"] == 2
    assert frames("centred", 1, 3) <= run.ran


def test_until_computes_what_a_task_needs_and_no_more(toys):
    run = toys.run(until=("cones",))
    assert set(run.counts) == {"points", "smooth", "intervals", "cones"}
    assert set(toys.run(until=("order", "cones")).counts) == {"total", "order"}


def test_forced_tasks_run_though_they_are_fresh(toys):
    toys.run()
    toys.clear()
    plan = toys.pipeline().plan(force=["smooth"])
    assert [str(r) for r in plan["smooth[frame=0]"].reasons] == ["forced"]
    run = toys.run(force=("smooth",))
    assert run.ran == frames("smooth", *range(6))
    assert len(toys.executions()) == 6
    assert toys.run().ran == set()


def test_frames_with_equal_content_compute_once(toys):
    toys.write(10, 10, 10, 10, 10, 10)
    run = toys.run(until=("smooth",))
    assert toys.executions() == ["points-10", "smooth-10"]
    assert run.told["nodes"] == {"ran": 2, "fresh": 10, "failed": 0, "skipped": 0}
    assert len({toys.artifacts()[f"smooth[frame={n}]"] for n in range(6)}) == 1


def test_twins_fail_together(toys):
    for file in sorted(toys.frames.iterdir())[2:]:
        file.unlink()
    toys.write(10, 10)
    toys.flag("fail-points-10")
    run = toys.run(until=("smooth",), compute={"executor": "threads", "workers": 2})
    assert set(run.heard.nodes("failed")) == frames("points", 0, 1)
    assert toys.executions() == ["points-10"]


def test_parts_in_a_copied_store_stay_fresh(toys, tmp_path):
    toys.run()
    before = toys.artifacts()
    shutil.copytree(toys.output / "store", tmp_path / "copy")
    run = toys.run(store=str(tmp_path / "copy"))
    assert run.ran == set()
    assert toys.artifacts(store=str(tmp_path / "copy")) == before


@pytest.mark.parametrize("seed", ["0", "1"])
def test_keys_are_the_same_in_every_process(toys, monkeypatch, seed):
    here = {n.node: n.key for n in toys.pipeline().plan(until=["points"]).nodes if n.task != "source"}
    monkeypatch.setenv("PYTHONHASHSEED", seed)
    told = toys.command("plan", str(toys.yaml()), "--until", "points", "--json")
    there = {n["node"]: n["key"] for n in json.loads(told.stdout)["nodes"] if n["task"] != "source"}
    assert len(here) == 6
    assert there == here


def test_planning_computes_and_writes_nothing(toys, monkeypatch):
    from kinetree.pipeline.running import execute, launch
    from kinetree.pipeline.storage import files

    def refuse(*_, **__):
        raise AssertionError("planning started something")

    toys.run(until=("smooth",))
    toys.clear()
    before = toys.stored()
    monkeypatch.setattr(files, "SETTLED_SECONDS", -1e9)
    monkeypatch.setattr(launch, "launcher", refuse)
    monkeypatch.setattr(execute, "execute", refuse)
    pipeline = toys.pipeline(points={"scale": 7.0})
    pipeline.plan()
    pipeline.graph(expanded=True)
    pipeline.why("report")
    pipeline.lineage("points[0]")
    assert toys.executions() == []
    assert toys.stored() == before


def test_planning_an_empty_store_makes_none(toys):
    toys.pipeline().plan()
    assert not toys.output.exists()


def test_files_that_settled_are_not_read_again(toys, monkeypatch):
    from kinetree.pipeline.storage import files

    monkeypatch.setattr(files, "SETTLED_SECONDS", -1e9)
    toys.run(until=("points",))
    monkeypatch.setattr(files, "file_digest", lambda path: pytest.fail(f"{path} was read again"))
    assert toys.run(until=("points",)).ran == set()
