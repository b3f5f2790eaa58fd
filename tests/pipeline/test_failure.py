"""What fails, and what does not: nodes that raise, artifacts that lost bytes, runs that were killed or share a store."""

import contextlib
import dataclasses
import json
import os
import shutil
import signal

import pytest
from zips import alter

from kinetree.errors import DamagedArtifactError
from kinetree.pipeline.planning.damage import MENDS
from kinetree.pipeline.running import launch, sight
from kinetree.pipeline.storage.place import Folder
from kinetree.pipeline.storage.records import Records
from kinetree.pipeline.storage.store import Store, artifact_path

TERMINAL = {"finish", "fresh", "failed", "skipped"}


@pytest.fixture
def calm(toys, tmp_path):
    """The artifacts of a run in which nothing went wrong, in a store of its own."""
    store = str(tmp_path / "calm")
    toys.run(store=store)
    toys.clear()
    return toys.artifacts(store=store)


def place_of(toys, digest):
    """Where an artifact lies."""
    return toys.output / "store" / artifact_path(digest)


def damage_in(toys, node, name, change):
    """Changes a file of the artifact of a node."""
    alter(place_of(toys, toys.artifacts()[node]), name, change)


def flip(data):
    """Alters one byte."""
    return data[:-1] + bytes([data[-1] ^ 0xFF])


def terminal(events):
    """The last word on every node: what was damaged is told again."""
    ends = {}
    for event in events:
        if event["event"] in TERMINAL:
            assert event["node"] not in ends, f"{event['node']} ended twice"
            ends[event["node"]] = event["event"]
        elif event["event"] == "damaged":
            del ends[event["node"]]
    return ends


def test_a_failing_node_fails_what_reads_it_and_nothing_else(toys, calm):
    toys.flag("fail-local-30")
    toys.flag("fail-cones-110")
    run = toys.run()
    assert run.told["status"] == "failed"
    assert sorted(run.heard.nodes("failed")) == ["cones[interval=2]", "local[interval=1,frame=2]"]
    assert set(run.heard.nodes("skipped")) == {"local[interval=2,frame=4]", "local[interval=2,frame=5]", "report"} | {
        n for n in run.heard.nodes("skipped") if n.startswith("piece[interval=2")
    }
    assert len(run.heard.nodes("finish")) == len(toys.executions()) - 2
    assert toys.artifacts()["track[frame=5]"] == calm["track[frame=5]"]


def test_after_the_cause_is_gone_only_failed_and_skipped_nodes_run(toys, calm):
    flags = [toys.flag("fail-local-30"), toys.flag("fail-total-210")]
    toys.run()
    for flag in flags:
        flag.unlink()
    run = toys.run()
    assert run.counts == {"total": 1, "centred": 6, "order": 1, "track": 6, "local": 1, "report": 1}
    assert toys.artifacts() == calm


def test_all_failures_are_told_and_run_json_has_the_documented_shape(toys):
    toys.flag("fail-points-20")
    toys.flag("fail-points-50")
    done = toys.command("run", str(toys.yaml()), "--log-json", str(toys.folder / "log.json"))
    assert done.returncode == 1
    assert "points[frame=1]: ValueError: points-20 was told to fail" in done.stderr
    assert "points[frame=4]: ValueError: points-50 was told to fail" in done.stderr
    assert "Traceback" not in done.stderr
    account = json.loads((toys.output / "run.json").read_text())
    assert set(account) == {"status", "nodes", "tasks", "failures", "seconds", "versions", "files"}
    assert account["status"] == "failed"
    # four frames are read and smoothed; all else gathers over six
    assert account["nodes"] == {"ran": 8, "fresh": 0, "failed": 2, "skipped": 18}
    assert set(account["tasks"]["points"]) == {"ran", "fresh", "failed", "seconds"}
    assert (account["tasks"]["points"]["ran"], account["tasks"]["points"]["failed"]) == (4, 2)
    assert sorted(account["failures"], key=lambda f: f["node"]) == [
        {"node": f"points[frame={n}]", "error": "ValueError", "message": f"points-{10 * n + 10} was told to fail"}
        for n in (1, 4)
    ]
    assert account["versions"]["python"].startswith("3.")
    log = [json.loads(line) for line in (toys.folder / "log.json").read_text().splitlines()]
    assert (log[0]["event"], log[-1]["event"], log[-1]["status"]) == ("run", "end", "failed")
    ends = terminal(log)
    assert {n for n, e in ends.items() if e == "failed"} == {"points[frame=1]", "points[frame=4]"}
    assert sum(e == "skipped" for e in ends.values()) == 18
    assert sum(e == "finish" for e in ends.values()) == 8
    traces = [e["trace"] for e in log if e["event"] == "failed"]
    assert all("was told to fail" in trace and "toys.py" in trace for trace in traces)


def test_every_node_of_a_log_has_one_end(toys):
    first = terminal(toys.run().heard.events)
    labels = {n.node for n in toys.pipeline().plan().nodes if n.task != "source"}
    assert set(first) == labels
    second = terminal(toys.run(intervals={"length": 3}).heard.events)
    assert set(second.values()) == {"finish", "fresh"}
    totals = [e for e in toys.run().heard.events if e["event"] == "layout"][-1]["totals"]
    assert sum(totals.values()) == len(labels)


def test_seconds_and_peak_memory_of_every_node_are_on_record(toys):
    run = toys.run()
    records = list(Store.at(toys.output / "store").records.all())
    assert len(records) == len(run.ran)
    assert all(r.seconds > 0 and r.peak_bytes > 2**20 for r in records)
    assert all(e["seconds"] > 0 and e["peak_bytes"] > 2**20 for e in run.heard.events if e["event"] == "finish")


def test_a_failing_opener_skips_what_it_would_have_opened(toys):
    toys.flag("fail-intervals-6")
    run = toys.run()
    assert run.heard.nodes("failed") == ["intervals"]
    assert run.heard.nodes("skipped") == ["report"]
    assert not {"cones", "piece", "local"} & {n.partition("[")[0] for n in run.ran}
    assert "track[frame=5]" in run.ran


def test_a_task_that_returns_something_else_is_told_what_it_promised(toys):
    toys.edit("return Centred(value=smooth.value - total.value / len(total.frames))", "return smooth")
    run = toys.run(until=("centred",))
    assert len(run.heard.nodes("failed")) == 6
    assert run.told["failures"][0]["message"] == "centred returned Smooth, its signature promises Centred"


def test_failure_in_the_middle_of_a_parcel_keeps_what_went_before(toys):
    """A frame's `points` and `smooth` travel together, yet each has its own record."""
    toys.flag("fail-smooth-30")
    run = toys.run(until=("total", "smooth"))
    assert "points[frame=2]" in run.ran
    assert run.heard.nodes("failed") == ["smooth[frame=2]"]
    assert run.heard.nodes("skipped") == ["total"]
    starts = [e["node"] for e in run.heard.events if e["event"] == "start"]
    assert starts.index("smooth[frame=2]") == starts.index("points[frame=2]") + 1
    (toys.flags / "fail-smooth-30").unlink()
    assert toys.run(until=("total", "smooth")).ran == {"smooth[frame=2]", "total"}


def remove_chunk(toys):
    damage_in(toys, "points[frame=2]", "x/c/0", lambda data: None)


def alter_chunk(toys):
    damage_in(toys, "points[frame=2]", "x/c/0", flip)


def alter_array_metadata(toys):
    damage_in(toys, "points[frame=2]", "x/zarr.json", lambda data: data.replace(b'"float64"', b'"uint64" '))


def alter_unit(toys):
    damage_in(toys, "points[frame=2]", "x/zarr.json", lambda data: data.replace(b'"length"', b'"degree"'))


def alter_group_metadata(toys):
    damage_in(toys, "points[frame=2]", "zarr.json", lambda data: data.replace(b'"Points"', b'"Pounts"'))


def remove_artifact(toys):
    place_of(toys, toys.artifacts()["points[frame=2]"]).unlink()


@pytest.mark.parametrize("damage", [remove_chunk, remove_artifact])
def test_a_missing_part_is_noticed_when_planning_and_mended(toys, calm, damage):
    toys.run()
    damage(toys)
    toys.clear()
    plan = toys.pipeline().plan()
    assert str(plan["points[frame=2]"]) == "points[frame=2]: stale (artifact: missing or damaged)"
    assert toys.run().ran == {"points[frame=2]"}
    assert toys.executions() == ["points-30"]
    assert toys.artifacts() == calm
    assert toys.pipeline().artifact("points", frame=2).x.tolist() == [30.0, 60.0, 90.0]


@pytest.mark.parametrize("damage", [alter_chunk, alter_array_metadata, alter_unit, alter_group_metadata])
@pytest.mark.parametrize("executor", ["sync", "threads"])
def test_altered_bytes_are_noticed_on_reading_and_mended(toys, damage, executor, tmp_path):
    toys.run()
    damage(toys)
    toys.clear()
    blocks = {"smooth": {"grain": 20.0}}
    run = toys.run(**blocks, compute={"executor": executor, "workers": 2})
    assert run.told["status"] == "done"
    assert "points[frame=2]" in run.ran
    assert toys.executions().count("points-30") == 1
    ends = terminal(run.heard.events)
    counted = {kind: sum(e == kind for e in ends.values()) for kind in ("finish", "fresh")}
    assert run.told["nodes"] == {"ran": counted["finish"], "fresh": counted["fresh"], "failed": 0, "skipped": 0}
    toys.run(**blocks, store=str(tmp_path / "other"))
    assert toys.artifacts(**blocks) == toys.artifacts(**blocks, store=str(tmp_path / "other"))
    assert toys.pipeline().artifact("points", frame=2).x.tolist() == [30.0, 60.0, 90.0]


def test_a_damaged_opener_is_noticed_when_planning_and_mended(toys, calm):
    toys.run()
    damage_in(toys, "intervals", "zarr.json", lambda data: data.replace(b"[2,3]", b"[3,2]").replace(b"2,\n", b"3,\n", 1))
    toys.clear()
    plan = toys.pipeline().plan()
    assert plan["intervals"].state == "stale"
    assert [r.kind for r in plan["intervals"].reasons] == ["artifact"]
    assert toys.run().ran == {"intervals"}
    assert toys.artifacts() == calm


def test_a_damaged_traversal_is_noticed_when_planning_and_mended(toys, calm):
    toys.run()
    damage_in(toys, "order", "frames/c/0", flip)
    toys.clear()
    plan = toys.pipeline().plan()
    assert str(plan["order"]) == "order: stale (artifact: array frames was altered)"
    assert str(plan["track[frame=0]"]) == "track[frame=0]: waits (for order)"
    assert toys.run().ran == {"order"}
    assert toys.artifacts() == calm


@pytest.mark.parametrize("executor", ["sync", "threads"])
def test_an_artifact_that_many_nodes_made_is_mended_once(toys, executor):
    """All frames are smoothed to nothing: one artifact, six keys, and several tasks that read it at the same time."""
    blocks = {"smooth": {"grain": 100.0}, "compute": {"executor": executor, "workers": 4}}
    toys.run(**blocks)
    alter(place_of(toys, toys.artifacts(**blocks)["smooth[frame=0]"]), "zarr.json", lambda data: data.replace(b"0.0", b"0.5"))
    run = toys.run(**blocks, force=("total", "intervals"))
    assert run.told["status"] == "done"
    assert run.counts == {"smooth": 6, "total": 1, "intervals": 1}
    assert toys.run(**blocks).ran == set()


def test_a_truncated_record_is_as_good_as_none(toys, calm):
    toys.run()
    key = toys.pipeline().why("total").key
    records = Records(Folder(toys.output / "store"))
    one = records.get(key)
    records.remove([key])
    records.put(one)
    path = toys.output / "store" / "records" / f"{key}.json"
    path.write_bytes(path.read_bytes()[:100])
    plan = toys.pipeline().plan()
    assert str(plan["total"]) == "total: stale (artifact: its record is missing or damaged)"
    assert toys.run().ran == {"total"}
    assert toys.artifacts() == calm


def test_any_number_of_damaged_inputs_is_mended(toys, calm):
    toys.run(until=("smooth",))
    for n in range(6):
        old, new = f"{10 * (n + 1)}.0".encode(), f"{10 * (n + 1)}.5".encode()
        damage_in(toys, f"smooth[frame={n}]", "zarr.json", lambda data, old=old, new=new: data.replace(old, new))
    run = toys.run()
    assert run.told["status"] == "done"
    assert run.counts["smooth"] == 6
    assert toys.artifacts() == calm


def test_an_artifact_that_cannot_be_mended_fails_what_reads_it(toys, monkeypatch):
    """A disk that alters what it stores: the node is told after a few tries, and the run comes to an end."""

    def lose(self, cls, digest):
        raise DamagedArtifactError(digest, "array x was altered")

    toys.run(until=("smooth",))
    monkeypatch.setattr(Store, "read", lose)
    run = toys.run(until=("total",))
    (failure,) = run.told["failures"]
    assert failure["node"] == "total"
    assert failure["message"].endswith("array x was altered, again after it was computed again; check the disk")
    assert terminal(run.heard.events)["smooth[frame=0]"] == "finish"


@pytest.mark.parametrize("executor", ["sync", "threads", "processes"])
def test_after_kill_9_of_the_whole_run_the_next_goes_on(toys, calm, executor):
    toys.flag("wait-total-210")
    process = toys.start("run", str(toys.yaml()), "--executor", executor, "--workers", "2", "--quiet")
    toys.until((toys.flags / "waiting-total-210").exists, "total begins", process)
    os.killpg(process.pid, signal.SIGKILL)
    process.communicate()
    assert process.returncode == -signal.SIGKILL
    (toys.flags / "wait-total-210").unlink()
    # points and smooth of all frames were through when the gather began
    toys.clear()
    run = toys.run()
    assert run.counts["total"] == 1
    assert not {"points", "smooth"} & set(run.counts)
    assert toys.artifacts() == calm


def test_store_removed_in_mid_run_is_a_store_again_and_every_command_accepts_it(toys, calm):
    toys.flag("wait-total-210")
    process = toys.start("run", str(toys.yaml()), "--quiet")
    toys.until((toys.flags / "waiting-total-210").exists, "total begins", process)
    shutil.rmtree(toys.output / "store")
    (toys.flags / "wait-total-210").unlink()
    _, err = process.communicate(timeout=60)
    assert (process.returncode, err) == (0, "")
    account = json.loads((toys.output / "run.json").read_text())
    plan = toys.pipeline().plan()
    assert (account["status"], plan.counts) == ("done", {"fresh": 49}), "what is called done is there"
    assert sum(account["nodes"].values()) == 43
    assert toys.command("plan", str(toys.output)).returncode == 0
    assert toys.command("run", str(toys.yaml()), "--quiet").returncode == 0
    assert toys.artifacts() == calm


def test_a_store_removed_while_the_workers_end_is_filled_again(toys, calm, monkeypatch):
    """After everything was looked for once more, and before the run is called done."""
    begun, plain = [], launch.launcher

    @contextlib.contextmanager
    def launcher(*given):
        with plain(*given) as there:
            begun.append(there)
            yield dataclasses.replace(there, is_elsewhere=True)
        if len(begun) == 1:
            shutil.rmtree(toys.output / "store")

    monkeypatch.setattr(launch, "launcher", launcher)
    account = toys.pipeline(compute={"executor": "threads"}).run()
    assert (account["status"], len(begun)) == ("done", 2)
    assert toys.artifacts() == calm


def test_a_store_that_loses_everything_again_and_again_is_never_done(toys, monkeypatch):
    """What is written is seen once and gone when the run is over."""
    sees = sight.sees

    def once(store, key, artifact):
        there = sees(store, key, artifact)
        shutil.rmtree(toys.output / "store" / "records")
        return there

    monkeypatch.setattr(sight, "sees", once)
    run = toys.run(until=("points",))
    assert run.told["status"] == "failed"
    assert [f["node"] for f in run.told["failures"]] == [f"points[frame={n}]" for n in range(6)]
    assert run.told["failures"][0]["message"].endswith("it is missing, again after it was computed again; check the disk")


def test_two_runs_at_once_share_a_store(toys, calm):
    toys.flag("wait-points-10")
    runs = [
        toys.start(
            "run", str(toys.yaml()), "--output", str(toys.folder / f"out{n}"), "--store", str(toys.output / "store"), "--quiet"
        )
        for n in (1, 2)
    ]
    toys.until(lambda: toys.executions().count("points-10") == 2, "both compute the first frame", *runs)
    (toys.flags / "wait-points-10").unlink()
    for run in runs:
        _, err = run.communicate(timeout=60)
        assert run.returncode == 0, err
    assert toys.artifacts() == calm
    assert toys.run().ran == set()


@pytest.mark.parametrize(("task", "skipped"), [("intervals", ["report"]), ("order", ["track", "report"])])
@pytest.mark.parametrize("executor", ["sync", "threads"])
def test_what_lays_out_the_graph_and_is_never_readable_fails_after_a_few_tries(toys, monkeypatch, executor, task, skipped):
    """A disk that loses the artifact which opens a space, or orders a traversal, as often as it is written."""
    whole = Store.read
    lost = toys.module.GRAPH.by_name[task].returns

    def read(self, cls, digest):
        if cls is lost:
            raise DamagedArtifactError(digest, "it is missing")
        return whole(self, cls, digest)

    monkeypatch.setattr(Store, "read", read)
    run = toys.run(compute={"executor": executor})
    assert run.told["status"] == "failed"
    (failure,) = run.told["failures"]
    assert failure["node"] == task
    assert failure["message"].endswith("it is missing, again after it was computed again; check the disk")
    assert sum(line.startswith(task) for line in toys.executions()) == MENDS + 1
    ends = terminal(run.heard.events)
    assert ends[task] == "failed"
    assert {node.partition("[")[0] for node, end in ends.items() if end == "skipped"} == set(skipped)
