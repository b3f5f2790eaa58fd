"""A data set: many sequences with one configuration, run side by side and summed up; toy sequences of text files."""

import contextlib
import json
import shutil
import sys
from dataclasses import replace
from multiprocessing import current_process
from types import SimpleNamespace

import pytest
from pipeline.lab import Lab

from kinetree.errors import ConfigError
from kinetree.pipeline.dataset.dataset import Dataset


@pytest.fixture
def lab(toys):
    return Lab.of(toys)


def test_all_sequences_run_and_are_summed_up(lab):
    record = lab.run()
    assert record["status"] == "done"
    assert lab.states(record) == {"a": "ran", "b": "ran", "c": "ran"}
    for name in "abc":
        report = lab.dataset()[name].artifact("report")
        assert lab.summary()[name] == report.value
    assert json.loads((lab.results / "dataset.json").read_text())["counts"]["ran"] == 3


def test_a_second_run_computes_nothing_and_writes_no_run(lab):
    lab.run()
    store = lab.results / "store"
    before = {file: file.stat().st_mtime_ns for file in store.rglob("*") if file.is_file()}
    record = lab.run()
    assert lab.states(record) == {"a": "fresh", "b": "fresh", "c": "fresh"}
    assert lab.toys.executions() == []
    assert {f: f.stat().st_mtime_ns for f in store.rglob("*") if f.is_file() and f.name != "files.json"} == {
        f: when for f, when in before.items() if f.name != "files.json"
    }


def test_what_helps_a_run_is_beside_a_whole_night_and_not_beside_one_with_nothing_to_do(lab, monkeypatch):
    heard = []

    @contextlib.contextmanager
    def beside():
        heard.append("begins")
        yield
        heard.append("ends")

    monkeypatch.setitem(sys.modules, "helper", SimpleNamespace(beside=beside))
    product = replace(lab.application(), beside="helper:beside")
    for _ in range(2):
        assert Dataset.of(lab.file, application=product).run()["status"] == "done"
        assert heard == ["begins", "ends"]


def test_a_worker_process_that_imports_the_script_leaves_nothing_behind(lab, monkeypatch):
    lab.write(compute={"executor": "processes", "workers": 1})
    monkeypatch.setattr(current_process(), "_inheriting", True, raising=False)
    before = sorted(lab.file.parent.rglob("*"))
    dataset = lab.dataset()
    for start in (dataset.run, dataset.report):
        with pytest.raises(ConfigError, match="started by a worker process"):
            start()
    assert [path for path in sorted(lab.results.rglob("*")) if path not in before and "store" not in path.parts] == []


def test_what_is_no_client_is_refused_in_words(lab):
    with pytest.raises(ConfigError, match=r"^expected a distributed\.Client to run on, got 'tcp://host:8786'"):
        lab.run(client="tcp://host:8786")


def test_a_changed_sequence_reruns_itself_and_the_summary_alone(lab):
    lab.run()
    lab.take("b", 30, 40, 500)
    record = lab.run()
    assert lab.states(record) == {"a": "fresh", "b": "ran", "c": "fresh"}
    ran = lab.toys.executions()
    assert sum(line.startswith("figure-") for line in ran) == 1
    assert sum(line.startswith("summed-") for line in ran) == 1
    assert "points-30" not in ran
    assert "points-10" not in ran


def test_a_removed_sequence_leaves_the_summary_and_nothing_else_runs(lab):
    lab.run()
    shutil.rmtree(lab.takes / "a")
    record = lab.run()
    assert list(lab.summary()) == ["b", "c"]
    assert lab.states(record) == {"b": "fresh", "c": "fresh"}
    assert lab.toys.executions() == ["summed-2"]


def test_a_new_sequence_runs_alone(lab):
    lab.run()
    lab.take("d", 80, 90)
    record = lab.run()
    assert lab.states(record) == {"a": "fresh", "b": "fresh", "c": "fresh", "d": "ran"}
    assert set(lab.summary()) == set("abcd")


def test_what_is_wrong_with_one_leaves_the_others_alone(lab):
    lab.toys.flag("fail-points-30")
    (lab.takes / "empty").mkdir()
    record = lab.run()
    assert record["status"] == "failed"
    assert lab.states(record) == {"a": "ran", "b": "failed", "c": "ran", "empty": "failed"}
    assert record["sequences"]["b"]["failures"][0]["message"] == "points-30 was told to fail"
    assert "no frames in" in record["sequences"]["empty"]["failures"][0]["message"]
    assert lab.summary()["b"] is None
    assert lab.summary()["a"] is not None


def test_only_what_failed_is_tried_again_where_that_is_asked_for(lab):
    flag = lab.toys.flag("fail-points-30")
    lab.run()
    flag.unlink()
    assert lab.dataset().plan()["b"].state == "failed"
    record = lab.run(failed=True)
    assert lab.states(record) == {"b": "ran"}
    assert lab.summary()["b"] is not None
    assert lab.run(failed=True)["sequences"] == {}


def test_a_plan_says_of_each_sequence_what_it_is_and_what_it_would_take(lab):
    assert {row.state for row in lab.dataset().plan().sequences} == {"new"}
    lab.run()
    lab.take("b", 30, 40, 500)
    lab.take("d", 1, 2)
    (lab.takes / "empty").mkdir()
    lab.toys.clear()
    plan = lab.dataset().plan()
    assert {row.name: row.state for row in plan.sequences} == {
        "a": "fresh", "b": "changed", "c": "fresh", "d": "new", "empty": "refused",
    }  # fmt: skip
    assert plan["b"].nodes > 0
    assert plan["b"].seconds is not None
    assert plan["d"].seconds is not None
    assert "source" in plan["b"].why
    assert lab.toys.executions() == []


def test_status_and_table_read_what_runs_left(lab):
    assert [row["status"] for row in lab.dataset().status()] == ["new"] * 3
    lab.run()
    assert [row["status"] for row in lab.dataset().status()] == ["done"] * 3
    rows = lab.dataset().table()
    assert [row["name"] for row in rows] == ["a", "b", "c"]
    assert all(row["value"] is not None for row in rows)


def test_overrides_reach_the_sequences_they_name(lab):
    lab.write(points={"scale": 2.0}, overrides={"b": {"points": {"scale": 3.0}}, "[ab]": {"smooth": {"grain": 5.0}}})
    dataset = lab.dataset()
    scales = {name: dataset[name].config.params["points"].scale for name in dataset}
    grains = {name: dataset[name].config.params["smooth"].grain for name in dataset}
    assert scales == {"a": 2.0, "b": 3.0, "c": 2.0}
    assert grains == {"a": 5.0, "b": 5.0, "c": 10.0}


def test_a_file_that_somebody_deleted_or_altered_is_back_after_a_run(lab):
    lab.run()
    (lab.results / "summary.json").unlink()
    lab.run()
    assert set(lab.summary()) == set("abc")
    (lab.results / "summary.json").write_text("{}")
    lab.run()
    assert set(lab.summary()) == set("abc")


def test_the_time_that_is_given_ends_a_run_and_the_next_goes_on(lab):
    record = lab.run(max_hours=0)
    assert lab.states(record) == {"a": "left", "b": "left", "c": "left"}
    assert lab.toys.executions() == ["summed-0"]
    assert lab.states(lab.run()) == {"a": "ran", "b": "ran", "c": "ran"}


def test_sequences_are_chosen_by_name_and_by_when_they_changed(lab):
    assert lab.states(lab.run(only=["a", "[c]"])) == {"a": "ran", "c": "ran"}
    assert lab.states(lab.run(since="2999-01-01")) == {}
    assert lab.states(lab.run(since="1h")) == {"a": "fresh", "b": "ran", "c": "fresh"}
    with pytest.raises(ConfigError, match="no sequence has such a name; there are: a, b, c"):
        lab.run(only=["walk*"])


def test_a_program_hears_of_failures_with_the_path_of_the_summary(lab):
    heard = lab.file.parent / "heard"
    script = lab.file.parent / "hook.py"
    script.write_text(f"import sys\nopen({str(heard)!r}, 'w').write('|'.join(sys.argv[1:]))")
    lab.write(on_failure=[shutil.which("python3") or "python3", str(script), "$(id) ; a b"])
    lab.run()
    assert not heard.exists()
    lab.toys.flag("fail-points-31")
    lab.take("b", 31, 40)
    lab.run()
    assert heard.read_text() == f"$(id) ; a b|{lab.results / 'dataset.json'}"


def test_a_program_that_is_not_there_is_told_of(lab):
    lab.write(on_failure=["/no/such/program"])
    lab.toys.flag("fail-points-30")
    assert "No such file" in lab.run()["on_failure"]


def test_what_no_run_needs_goes_where_that_is_asked_for(lab):
    lab.write(retention={"keep_last": 1})
    lab.run()
    before = len(list((lab.results / "store" / "artifacts").rglob("*.zip")))
    lab.take("b", 300, 400, 500)
    record = lab.run()
    assert record["deleted"]["artifacts"] > 0
    assert len(list((lab.results / "store" / "artifacts").rglob("*.zip"))) <= before
    assert lab.states(lab.run()) == {"a": "fresh", "b": "fresh", "c": "fresh"}


def test_a_store_that_somebody_removed_is_filled_again(lab):
    lab.run()
    shutil.rmtree(lab.results / "store")
    record = lab.run()
    assert lab.states(record) == {"a": "ran", "b": "ran", "c": "ran"}
    assert all(value is not None for value in lab.summary().values())


@pytest.mark.parametrize("change", ["parameter", "code"])
def test_other_parameters_or_code_make_a_sequence_stale(lab, change):
    lab.run()
    if change == "parameter":
        lab.write(overrides={"b": {"points": {"scale": 7.0}}})
    else:
        lab.toys.edit("return Report(value=value)", "return Report(value=2 * value)")
    record = lab.run()
    assert record["sequences"]["b"]["state"] == "ran"
    assert record["sequences"]["a"]["state"] == ("fresh" if change == "parameter" else "ran")


def test_an_edit_that_changes_no_result_leaves_all_alone(lab):
    lab.run()
    lab.toys.edit("The numerics of the toy graph", "The formulas of the toy graph", "toy_sums.py")
    assert set(lab.states(lab.run()).values()) == {"fresh"}
