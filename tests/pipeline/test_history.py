"""Runs on record: what they used, where two of them differ, and why a node would run again."""

import json

import pytest

from kinetree.errors import UnknownNodeError
from kinetree.pipeline.inspection.look import RunList
from kinetree.pipeline.planning.reason import Work, differences
from kinetree.pipeline.storage.store import Record


def why(toys, node, **blocks):
    return str(toys.pipeline(**blocks).why(node))


def test_a_node_that_never_ran_says_so(toys):
    assert why(toys, "points[0]") == "points[frame=0]: stale (never ran)"
    assert why(toys, "total") == "total: waits (for smooth[frame=0], smooth[frame=1], smooth[frame=2] and 3 more)"
    assert why(toys, "track[5]") == "track[frame=5]: waits (for order)"


def test_a_changed_parameter_is_told_old_and_new(toys):
    toys.run()
    changed = {"intervals": {"length": 3}}
    assert why(toys, "intervals", **changed) == "intervals: stale (params: length 2 → 3)"
    assert why(toys, "points[1]", **changed) == "points[frame=1]: fresh"
    assert why(toys, "report", **changed) == "report: waits (for intervals)"


def test_a_changed_input_is_named(toys):
    toys.run()
    toys.write(44, start=3)
    assert why(toys, "points[3]") == "points[frame=3]: stale (input: source[frame=3] changed)"
    toys.run(until=("smooth",))
    toys.write(70, start=6)
    toys.run(until=("smooth",))
    assert why(toys, "total") == "total: stale (input: smooth[frame=6] added)"
    assert why(toys, "intervals") == "intervals: stale (input: smooth[frame=6] added)"
    toys.run()
    for n in range(4):
        (toys.frames / f"{n + 3:05d}.txt").unlink()
    assert why(toys, "total").startswith(
        "total: stale (input: smooth[frame=3], smooth[frame=4], smooth[frame=5] and 1 more removed"
    )


def test_changed_code_is_named_by_definition(toys):
    toys.run()
    toys.edit("return int(value) % 2", "return int(value) & 1", "toy_sums.py")
    assert why(toys, "cones[0]") == f"cones[interval=0]: stale (code: {toys.name}.toy_sums:parity)"
    assert why(toys, "points[0]") == "points[frame=0]: fresh"


def test_much_changed_code_of_one_module_is_told_in_short():
    before = {"a.b": "f:000001 g:000001 h:000001 k:000001", "a.c": "f:000001"}
    now = {"a.b": "f:000002 g:000002 h:000002 m:000001", "a.c": "f:000001"}
    assert [str(r) for r in differences(Work({}, now, []), recorded(before))] == ["code: a.b:f, g, h and 2 more"]


def test_the_order_of_imports_has_words_and_no_module():
    before, now = {"": "(statements):000001", "a.b": "f:000001"}, {"": "(statements):000002", "a.b": "f:000001"}
    assert [str(r) for r in differences(Work({}, now, []), recorded(before))] == ["code: the order of imports"]


def test_code_that_a_record_tells_by_whole_modules_is_told_in_one_reason():
    found = differences(Work({}, {"a.b": "f:000001"}, []), recorded({"a.b": "0" * 40, "a.c": "1" * 40}))
    assert [str(r) for r in found] == ["code: the earlier run identified it by whole modules"]


def recorded(code):
    return Record("key", "task", {}, "artifact", {}, {}, code, [], 0.0, 0, "host", "now")


def test_all_that_changed_is_told(toys):
    toys.run()
    toys.edit("return Points(x=params.scale", "return Points(x=1.0 * params.scale")
    toys.write(11)
    assert why(toys, "points[0]", points={"scale": 2.0}) == (
        f"points[frame=0]: stale (params: scale 1.0 → 2.0; code: {toys.name}.toys:points; input: source[frame=0] changed)"
    )


def test_a_plan_counts_by_task(toys):
    toys.run()
    rows = {row.task: str(row) for row in toys.pipeline(smooth={"grain": 20.0}).plan().tasks}
    assert rows["points"] == "points ×6: 6 fresh"
    assert rows["smooth"] == "smooth ×6: 6 stale — params: grain 10.0 → 20.0 ×6"
    assert rows["cones"] == "cones ×0: more once intervals is computed"
    assert rows["total"].startswith("total: waits — waits for smooth[frame=0]")


def test_reasons_are_told_against_the_last_run_into_the_same_folder(toys, tmp_path):
    shared = {"store": str(toys.output / "store")}
    toys.run()
    toys.run(**shared, output=str(tmp_path / "other"), intervals={"length": 3})
    assert why(toys, "intervals", intervals={"length": 4}) == "intervals: stale (params: length 2 → 4)"
    other = {**shared, "output": str(tmp_path / "other"), "intervals": {"length": 4}}
    assert why(toys, "intervals", **other) == "intervals: stale (params: length 3 → 4)"


def test_reasons_are_not_told_against_the_run_of_another_folder(toys, tmp_path):
    shared = {"store": str(toys.output / "store"), "output": str(tmp_path / "other")}
    toys.run()
    assert why(toys, "intervals", **shared, intervals={"length": 4}) == "intervals: stale (never ran)"
    toys.write(77)
    toys.run(**shared)
    toys.write(10)
    assert why(toys, "points[0]", points={"scale": 2.0}) == "points[frame=0]: stale (params: scale 1.0 → 2.0)"


def test_reasons_survive_a_run_that_stopped_early(toys):
    toys.run()
    toys.run(until=("points",))
    assert why(toys, "intervals", intervals={"length": 4}) == "intervals: stale (params: length 2 → 4)"


def test_every_run_is_on_record_with_its_counts(toys):
    toys.flag("fail-total-210")
    toys.run()
    (toys.flags / "fail-total-210").unlink()
    toys.run()
    toys.run()
    runs = toys.pipeline().runs()
    assert [run["status"] for run in runs] == ["failed", "done", "done"]
    assert [run["counts"]["ran"] for run in runs][1:] == [15, 0]
    assert runs[0]["failures"][0]["node"] == "total"
    assert len({run["name"] for run in runs}) == 3
    assert "nodes" in toys.pipeline().store.run(runs[0]["name"])


def difference(toys):
    return toys.pipeline().diff(*[run["name"] for run in toys.pipeline().runs()][-2:])


def test_a_run_does_not_differ_from_its_repetition(toys):
    toys.run()
    toys.run()
    changes = difference(toys)
    assert (changes["only_a"], changes["only_b"], changes["changed"], changes["begins"]) == ([], [], [], {})


def test_a_difference_begins_at_the_parameter_that_differs(toys):
    toys.run()
    toys.run(intervals={"length": 3})
    changes = difference(toys)
    assert changes["begins"] == {"intervals": ["params: length 2 → 3"]}
    gone = {"cones[interval=2]", "piece[interval=0,cone=1]", "piece[interval=2,cone=0]", "piece[interval=2,cone=1]"}
    assert set(changes["only_a"]) == gone | {f"local[interval={n // 2},frame={n}]" for n in (2, 4, 5)}
    assert {"intervals", "cones[interval=0]", "report"} <= set(changes["changed"])
    assert not any(n.startswith(("points", "smooth", "track")) for n in changes["changed"])


def test_a_difference_begins_at_the_frame_that_was_replaced(toys):
    toys.run()
    toys.write(88, start=2)
    toys.run()
    changes = difference(toys)
    assert list(changes["begins"]) == ["source[frame=2]"]
    assert changes["begins"]["source[frame=2]"][0].startswith("input: ")
    assert "report" in changes["changed"]


def test_a_difference_begins_at_the_code_that_was_edited(toys):
    toys.run()
    toys.edit("return Centred(value=smooth.value -", "return Centred(value=2.0 * smooth.value -")
    toys.run()
    changes = difference(toys)
    assert changes["begins"]["centred[frame=0]"] == [f"code: {toys.name}.toys:centred"]
    assert {"centred[frame=0]", "track[frame=0]", "report"} <= set(changes["changed"])
    assert "total" not in changes["changed"]


def test_other_parameters_with_equal_results_are_told_though_nothing_changed(toys):
    toys.run()
    toys.run(smooth={"grain": 5.0})
    changes = difference(toys)
    assert changes["changed"] == []
    assert changes["begins"] == {f"smooth[frame={n}]": ["params: grain 10.0 → 5.0"] for n in range(6)}


def test_a_run_nobody_knows_is_refused(toys):
    toys.run(until=("points",))
    with pytest.raises(UnknownNodeError, match="no run 'yesterday'"):
        toys.pipeline().diff("yesterday", "today")


def test_what_is_told_reads_well_and_is_still_plain(toys):
    first, second = toys.run().told, toys.run(smooth={"grain": 20.0}).told
    assert repr(first).startswith(f"{first['run']} done: ")
    assert json.loads(json.dumps(first)) == dict(first)
    runs = toys.pipeline().runs()
    assert repr(runs).splitlines()[1].startswith(first["run"])
    assert runs._repr_html_().count("<tr>") == 1 + len(runs)
    changes = toys.pipeline().diff(first["run"], second["run"])
    assert "starts at smooth[frame=0]: params: grain 10.0 → 20.0" in repr(changes)
    assert "<script>" not in RunList([{"name": "<script>"}])._repr_html_()
