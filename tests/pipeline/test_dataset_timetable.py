"""A data set on a timetable: started at any time, twice at once, killed, without a disk or a cluster."""

import json
import os
import re
import shutil
import signal
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest
from pipeline.lab import Lab

from kinetree.errors import ClusterError, StoreFullError
from kinetree.pipeline.application import Section, built_in
from kinetree.pipeline.command_line.cli import command_line
from kinetree.pipeline.running.workers import Workers
from kinetree.pipeline.storage.place import Folder

PAGE = Path(__file__).parents[2] / "docs" / "TIMETABLE.md"


@pytest.fixture
def lab(toys):
    return Lab.of(toys)


def start(lab, *options):
    return lab.toys.start("dataset", "run", str(lab.file), *options)


def ended(process):
    out, err = process.communicate(timeout=120)
    return process.returncode, out, err


def test_two_runs_at_once_share_the_sequences(lab):
    lab.take("d", 80, 90)
    flag = lab.toys.flag("wait-points-10")
    first = start(lab, "--json", "--only", "[ab]")
    lab.toys.until((lab.toys.flags / "waiting-points-10").exists, "the first run is at a", first)
    code, out, _ = ended(start(lab, "--json"))
    assert code == 0
    record = json.loads(out)
    assert lab.states(record)["a"] == "elsewhere"
    assert re.fullmatch(rf"process {first.pid} on .* is at it", record["sequences"]["a"]["why"])
    assert lab.summary()["a"] is None
    flag.unlink()
    code, out, _ = ended(first)
    assert (code, json.loads(out)["status"]) == (0, "done")
    assert all(value is not None for value in lab.summary().values())
    events = [json.loads(line) for line in (lab.results / "dataset.log").read_text().splitlines()]
    ran = [(event["name"], event["node"]) for event in events if event["event"] == "finish"]
    assert len(ran) == len(set(ran)), "a node was computed twice"


def test_a_killed_run_is_taken_over_at_once_and_nothing_finished_is_computed_again(lab):
    flag = lab.toys.flag("wait-points-60")
    killed = start(lab)
    lab.toys.until((lab.toys.flags / "waiting-points-60").exists, "the run is at c", killed)
    os.kill(killed.pid, signal.SIGKILL)
    killed.communicate()
    flag.unlink()
    plan = lab.dataset().plan()
    assert plan["c"].state in ("new", "unfinished")
    record = lab.run()
    assert record["status"] == "done"
    assert "points-60" in lab.toys.executions()
    assert not {"points-10", "points-20"} & set(lab.toys.executions())
    assert all(value is not None for value in lab.summary().values())


def test_an_interrupted_run_says_so_and_the_next_goes_on(lab):
    lab.write(compute={"executor": "threads", "workers": 1})
    flag = lab.toys.flag("wait-points-30")
    stopped = start(lab)
    lab.toys.until((lab.toys.flags / "waiting-points-30").exists, "the run is at b", stopped)
    stopped.send_signal(signal.SIGTERM)
    code, _, _ = ended(stopped)
    assert code == 130
    assert lab.last_run()["status"] == "interrupted"
    flag.unlink()
    assert lab.dataset().plan()["b"].state in ("unfinished", "new")
    assert lab.run()["status"] == "done"


def test_nothing_new_prints_nothing_and_json_says_all(lab):
    code, out, err = ended(start(lab))
    assert code == 0
    assert "a: done, " in err
    assert out.startswith("done: 3 ran in ")
    assert ended(start(lab)) == (0, "", "")
    code, out, err = ended(start(lab, "--json"))
    assert (code, err) == (0, "")
    assert json.loads(out)["counts"] == {"ran": 0, "fresh": 3, "failed": 0, "elsewhere": 0, "left": 0}


def test_failures_are_printed_also_where_all_else_is_quiet(lab):
    lab.toys.flag("fail-points-30")
    code, out, err = ended(start(lab, "--quiet"))
    assert (code, out) == (1, "")
    assert err == "b: points[frame=0]: ValueError: points-30 was told to fail\n"


def test_a_full_disk_ends_the_run_and_is_told_of(lab, monkeypatch):
    heard = lab.file.parent / "heard"
    lab.write(on_failure=["touch", str(heard)])
    put, count = Folder.put, iter(range(10_000))

    def full(place, path, data):
        if "artifacts" in path and next(count) > 20:
            raise StoreFullError("no space left")
        put(place, path, data)

    with monkeypatch.context() as patched:
        patched.setattr(Folder, "put", full)
        with pytest.raises(StoreFullError):
            lab.run()
    assert lab.last_run()["status"] == "stopped"
    assert "no space left" in lab.last_run()["error"]
    assert heard.exists()
    assert lab.run()["status"] == "done"


def test_a_cluster_that_goes_away_ends_the_run_and_the_next_goes_on(lab, monkeypatch):
    def away(workers, jobs, store):
        raise ClusterError("nobody answers")

    with monkeypatch.context() as patched:
        patched.setattr(Workers, "run", away)
        with pytest.raises(ClusterError):
            lab.run()
    assert lab.last_run()["status"] == "stopped"
    assert lab.dataset().status()[0]["status"] in ("stopped", "new")
    assert lab.run()["status"] == "done"


def test_json_is_printed_also_where_the_run_was_stopped(lab, monkeypatch, capsys):
    def away(workers, jobs, store):
        raise ClusterError("nobody answers")

    monkeypatch.setattr(Workers, "run", away)
    application = replace(lab.application(), sections=(Section("All", (built_in("dataset"),)),))
    with application.active(), pytest.raises(ClusterError):
        command_line(application)(["dataset", "run", str(lab.file), "--json"], standalone_mode=False)
    assert json.loads(capsys.readouterr().out)["error"] == "ClusterError: nobody answers"


def test_a_folder_that_cannot_be_written_is_one_sequences_failure(lab):
    lab.results.mkdir(parents=True)
    (lab.results / "b").write_text("a file where a folder should be")
    record = lab.run()
    assert lab.states(record) == {"a": "ran", "b": "failed", "c": "ran"}
    assert "cannot be written" in record["sequences"]["b"]["failures"][0]["message"]


def test_somebody_elses_file_is_not_replaced(lab):
    (lab.results / "b").mkdir(parents=True)
    (lab.results / "b" / "run.json").write_text("mine")
    record = lab.run()
    assert lab.states(record) == {"a": "ran", "b": "failed", "c": "ran"}
    assert (lab.results / "b" / "run.json").read_text() == "mine"


def test_logs_rotate(lab):
    lab.write(retention={"log_size": "1kB", "logs": 2})
    lab.run()
    names = sorted(file.name for file in lab.results.glob("dataset.log*"))
    assert names == ["dataset.log", "dataset.log.1", "dataset.log.2"]
    events = [json.loads(line) for name in names for line in (lab.results / name).read_text().splitlines()]
    assert {event["name"] for event in events} <= set("abc")


def test_a_damaged_artifact_of_a_sequence_fails_the_summary_once_and_is_made_again(lab):
    lab.run()
    report = lab.dataset()["a"].plan()["report"].artifact
    lab.take("d", 80, 90)  # so that the summary is made again
    path = lab.results / "store" / "artifacts" / report[:2] / f"{report}.zip"
    figures = [n.artifact for n in lab.dataset()["a"].plan().nodes]
    assert report in figures
    data = path.read_bytes()
    path.write_bytes(data[:-30] + bytes(30))
    lab.toys.edit("return Figure(value=report.value)", "return Figure(value=report.value + 0.0)", "toy_datasets.py")
    record = lab.run()
    assert record["status"] == "failed"
    assert record["summary"]["failures"]
    record = lab.run()
    assert record["status"] == "done"
    assert lab.summary()["a"] is not None


def code_block(language, after):
    """The first block in a language after a heading of the page."""
    text = PAGE.read_text()
    return re.findall(rf"```{language}\n(.*?)```", text[text.index(after) :], re.DOTALL)


@pytest.mark.skipif(shutil.which("systemd-analyze") is None, reason="systemd is not installed")
def test_systemd_understands_the_units_of_the_page(tmp_path):
    service, timer = code_block("ini", "## systemd")[:2]
    program = tmp_path / "kinetree"
    program.write_text("#!/bin/sh\n")
    program.chmod(0o755)
    (tmp_path / "kinetree-lab.service").write_text(service.replace("/opt/kinetree/bin/kinetree", str(program)))
    (tmp_path / "kinetree-lab.timer").write_text(timer)
    units = [str(tmp_path / f"kinetree-lab.{kind}") for kind in ("service", "timer")]
    done = subprocess.run(["systemd-analyze", "verify", "--man=no", *units], capture_output=True, text=True, check=False)
    assert [line for line in done.stderr.splitlines() if "kinetree-lab" in line] == []


def test_the_commands_of_the_page_are_those_there_are(lab):
    for line in re.findall(r"kinetree dataset [^\n|`\"]*", PAGE.read_text()):
        words = line.replace("/data/lab.yaml", str(lab.file)).replace("FILE", str(lab.file)).split()[2:]
        assert words[0].rstrip(",]") in ("run", "plan", "status", "report", "run,")


def test_the_file_of_the_page_is_a_data_set():
    from kinetree.pipeline.dataset.dataset import Dataset
    from kinetree.pipeline.settings.yaml_text import parsed
    from kinetree.tasks.application import APPLICATION

    blocks = parsed(code_block("yaml", "# Many")[0], "page")
    dataset = Dataset.of(
        {**blocks, "sequences": {"walk_07": "/takes/walk_07", "dance_1": "/takes/dance_1"}}, application=APPLICATION
    )
    assert dataset["dance_1"].config.params["sequence"].fps == 60
    assert dataset["walk_07"].config.params["source"].frames == "10:80"
    assert dataset.config.retention.keep_last == 2
    assert dataset.config.notes == ("{input}/truth.json: there is none for dance_1, walk_07",)
