"""One look at the graph answers many questions, with the same answers as one look for each."""

import re

import pytest

from kinetree.errors import ConfigError, UnknownNodeError
from kinetree.pipeline.planning.layout import Layout


def test_every_question_to_one_snapshot_lays_the_graph_out_once(toys, monkeypatch):
    toys.run()
    laid_out, original = [], Layout.__init__
    monkeypatch.setattr(Layout, "__init__", lambda self, *given: (laid_out.append(1), original(self, *given))[1])
    there = toys.pipeline().inspect()
    there.plan, there.graph, there.nodes, there.timings, there.estimate(), there.remarks()
    there.why("total"), there.lineage("points[2]"), there.artifact("points", frame=3)
    assert len(laid_out) == 1


def test_a_snapshot_answers_as_the_pipeline_does(toys):
    toys.run()
    toys.write(44, start=3)
    there, pipeline = toys.pipeline().inspect(), toys.pipeline()
    assert there.plan.json() == pipeline.inspect().plan.json()
    assert there.why("points[3]") == pipeline.why("points[3]")
    assert set(there.lineage("points[2]").edges) == set(pipeline.lineage("points[2]").edges)
    assert there.artifact("points", frame=2) == pipeline.artifact("points", frame=2)


def test_what_a_run_left_answers_as_a_new_look_does(toys):
    pipeline = toys.pipeline()
    for _ in ("a first run", "nothing to do"):
        left, looked = pipeline.run().there, pipeline.inspect()
        assert sorted(map(str, left.plan.nodes)) == sorted(map(str, looked.plan.nodes))
        assert left.plan.counts == looked.plan.counts
        assert left.plan.is_done
        assert left.why("points[2]") == looked.why("points[2]")
    forced = pipeline.run(force=["points"]).there
    assert forced.plan.is_done
    assert "forced" not in repr(forced)


def test_an_artifact_is_found_by_its_class_as_by_its_task(toys):
    toys.run()
    there, module = toys.pipeline().inspect(), toys.module
    assert isinstance(there.artifact(module.Points, frame=3), module.Points)
    assert there.artifact(module.Points, frame=3) == there.artifact("points", frame=3)
    with pytest.raises(UnknownNodeError, match=r"^points runs over frame; got no index$"):
        there.artifact(module.Points)


def test_an_artifact_that_nobody_writes_is_refused_by_its_name(toys):
    toys.run()
    stranger = type("Stranger", (toys.module.Total,), {})
    with pytest.raises(UnknownNodeError, match="no task of this graph writes Stranger"):
        toys.pipeline().inspect().artifact(stranger)


@pytest.mark.parametrize("what", [None, 3, [], b"points"])
def test_what_names_no_artifact_and_no_node_is_refused_in_words(toys, what):
    toys.run(until=("points",))
    pipeline = toys.pipeline()
    got = re.escape(repr(what))
    for ask in (pipeline.artifact, pipeline.inspect().artifact):
        with pytest.raises(UnknownNodeError, match=f"^expected an artifact's class or a task's name, got {got}$"):
            ask(what)
    for ask in (pipeline.why, pipeline.lineage):
        with pytest.raises(UnknownNodeError, match=f"^{got}: not a node; write a task, or a task with its index"):
            ask(what)


def test_a_graph_shows_itself_as_text_table_and_drawing(toys):
    toys.run()
    drawn = toys.pipeline().lineage("smooth[2]")
    assert "smooth[frame=2]: fresh ← points[frame=2]" in repr(drawn)
    bundle = drawn._repr_mimebundle_()
    assert bundle["text/vnd.mermaid"].startswith("flowchart TD")
    assert "<td>smooth[frame=2]</td>" in bundle["text/html"]
    assert "points ×6: fresh" not in repr(drawn)
    assert "points: 6 fresh ← source" in repr(toys.pipeline().graph())


def test_a_large_graph_is_listed_in_part_and_not_drawn(toys):
    toys.write(*range(400))
    drawn = toys.pipeline().graph(expanded=True)
    assert repr(drawn).splitlines()[-1] == f"… and {len(drawn) - 40} more"
    assert "text/vnd.mermaid" not in drawn._repr_mimebundle_()


def test_timings_are_those_of_the_records(toys):
    toys.run()
    there = toys.pipeline().inspect()
    entries = [e for e in there.schedule.entries.values() if e.node.task == "points"]
    (row,) = [row for row in there.timings.tasks if row.task == "points"]
    assert row.nodes == 6
    assert row.seconds == pytest.approx(sum(e.record.seconds for e in entries))
    assert row.longest == max(e.record.seconds for e in entries)
    assert row.bytes == sum(e.record.bytes for e in entries)
    assert there.timings.seconds == pytest.approx(sum(row.seconds for row in there.timings.tasks))


def test_an_estimate_without_any_run_names_what_is_unknown(toys):
    expected = toys.pipeline().inspect().estimate()
    assert expected.seconds == 0
    assert {"points", "smooth", "total"} <= set(expected.unknown)


def test_an_estimate_counts_what_the_same_nodes_took(toys):
    toys.run()
    entries = toys.pipeline().inspect().schedule.entries.values()
    expected = toys.pipeline().inspect(force=["points"]).estimate()
    forced = sum(e.node.task == "points" for e in entries)
    assert expected.nodes - expected.waiting == forced < expected.nodes
    assert f"{expected.waiting} of which run only if what they wait for changes" in str(expected)
    assert expected.by_task["points"] == pytest.approx(sum(e.record.seconds for e in entries if e.node.task == "points"))
    assert expected.unknown == ()


def test_an_estimate_of_an_added_frame_takes_the_mean_of_the_others(toys):
    toys.run()
    before = [e.record.seconds for e in toys.pipeline().inspect().schedule.entries.values() if e.node.task == "points"]
    toys.write(70, start=6)
    assert toys.pipeline().inspect().estimate().by_task["points"] == pytest.approx(sum(before) / 6)


def test_nothing_to_do_takes_no_time(toys):
    toys.run()
    expected = toys.pipeline().inspect().estimate()
    assert (expected.seconds, expected.nodes) == (0, 0)


def test_results_made_with_a_distrusted_version_are_out_of_date(toys):
    toys.run()
    pipeline = toys.pipeline()
    assert pipeline.plan(made_with=["numpy<1"]).is_done
    assert not pipeline.plan(made_with=["numpy>=1"]).is_done
    reason = str(pipeline.inspect(made_with=["numpy>=1"]).why("points[0]").reasons[0])
    assert reason.startswith("made with: numpy ")


def test_a_run_computes_anew_what_was_made_with_a_distrusted_version(toys):
    toys.run()
    before = toys.artifacts()
    toys.clear()
    toys.pipeline().run(made_with=["numpy>=1"])
    assert "points-30" in toys.executions()
    assert toys.artifacts() == before


@pytest.mark.parametrize("text", ["scipy", "scipy<", "", "<1.17", "scipy 1.17"])
def test_what_is_no_library_with_versions_is_refused(toys, text):
    with pytest.raises(ConfigError, match="made with"):
        toys.pipeline().plan(made_with=[text])


def test_an_added_frame_is_where_a_difference_begins(toys):
    toys.run()
    toys.write(70, start=6)
    toys.run()
    first, second = [run["name"] for run in toys.pipeline().runs()][-2:]
    assert toys.pipeline().diff(first, second)["begins"] == {"source[frame=6]": ["input: added"]}
    assert toys.pipeline().diff(second, first)["begins"] == {"source[frame=6]": ["input: removed"]}
