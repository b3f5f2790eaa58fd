"""What a collection frees, and what it must not."""

import contextlib
import os
import signal
import time
from dataclasses import asdict, replace

import pytest

from kinetree.errors import StoreError, StoreFullError, UnknownNodeError
from kinetree.pipeline.storage import gc
from kinetree.pipeline.storage.gc import advising, collect
from kinetree.pipeline.storage.records import Records
from kinetree.pipeline.storage.sealed import sealed
from kinetree.pipeline.storage.store import Store


def store(toys):
    return Store.at(toys.output / "store")


def names(toys):
    return [run["name"] for run in toys.pipeline().runs()]


def test_what_the_last_run_used_stays(toys):
    toys.run()
    toys.run(intervals={"length": 3})
    freed = collect(store(toys))
    # of the first run only what the second does not use: its intervals, cones, cuts and report
    assert len(freed.runs) == 1
    assert len(freed.records) == 1 + 3 + 3 + 6 + 1
    assert toys.run(intervals={"length": 3}).ran == set()
    assert toys.run().counts == {"intervals": 1, "cones": 3, "piece": 3, "local": 6, "report": 1}


def test_the_last_runs_and_named_runs_keep_what_they_used(toys):
    toys.run()
    toys.run(intervals={"length": 3})
    toys.run(intervals={"length": 4})
    first, *_ = names(toys)
    assert collect(store(toys), last=3, dry=True).artifacts == ()
    assert collect(store(toys), last=5, dry=True).artifacts == ()
    collect(store(toys), keep=[first], last=1)
    assert toys.run().ran == set()
    assert toys.run(intervals={"length": 4}).ran == set()
    assert toys.run(intervals={"length": 3}).counts["intervals"] == 1


def test_a_named_run_alone_is_kept_where_only_it_is_named(toys):
    toys.run()
    toys.run(intervals={"length": 3})
    collect(store(toys), keep=names(toys)[:1])
    assert toys.run().ran == set()
    with pytest.raises(UnknownNodeError, match="no run 'yesterday'"):
        collect(store(toys), keep=["yesterday"])


def test_a_dry_collection_frees_nothing_and_says_what_a_real_one_then_frees(toys):
    toys.run()
    toys.run(points={"scale": 1.3})
    before = toys.stored()
    collected = collect(store(toys), dry=True)
    assert toys.stored() == before
    assert collect(store(toys)) == collected
    after = toys.stored()
    artifacts = {path for path in before if path.startswith("artifacts/")} - set(after)
    assert {path.split("/")[2].removesuffix(".zip") for path in artifacts} == set(collected.artifacts)
    lists = {path for path in before if path.startswith("nodes/")} - set(after)
    assert sum(len(before[path]) for path in {*artifacts, *lists}) == collected.bytes
    assert lists == set(collected.leftovers)
    assert not {record.key for record in store(toys).records.all()} & set(collected.records)
    assert set(after) <= set(before)
    assert collect(store(toys), dry=True).artifacts == ()


def test_records_that_nobody_needs_are_not_read(toys, monkeypatch):
    toys.run()
    toys.run(points={"scale": 2.0})
    read, plain = [], Records.get
    monkeypatch.setattr(Records, "get", lambda self, key, **named: read.append(key) or plain(self, key, **named))
    freed = collect(toys.pipeline().store, dry=True)
    assert len(freed.records) > 16, "they lie in a pack"
    assert read
    assert not set(read) & set(freed.records)


def test_a_run_that_computed_nothing_leaves_nothing_but_its_own_record(toys):
    toys.run()
    before = set(toys.stored())
    assert toys.run().ran == set()
    (name,) = names(toys)[1:]
    assert set(toys.stored()) - before == {f"runs/{name}.json"}
    assert collect(store(toys), dry=True).leftovers == ()


def test_an_artifact_two_runs_share_stays_with_either(toys):
    toys.run()
    toys.run(smooth={"grain": 5.0})
    # the second run's own records name the first one's artifacts
    freed = collect(store(toys))
    assert len(freed.records) == 6
    assert freed.artifacts == ()
    assert toys.run(smooth={"grain": 5.0}).ran == set()


def test_every_output_folder_keeps_its_last_run(toys, tmp_path):
    shared = {"store": str(toys.output / "store")}
    toys.run()
    toys.run(**shared, output=str(tmp_path / "other"), intervals={"length": 3})
    assert collect(store(toys)).artifacts == ()
    assert toys.run(**shared).ran == set()


def test_a_run_under_way_is_safe(toys):
    toys.run(points={"scale": 1.3})
    toys.flag("wait-total-210")
    process = toys.start("run", str(toys.yaml()), "--quiet")
    toys.until((toys.flags / "waiting-total-210").exists, "total begins", process)
    freed = collect(store(toys), last=0)
    assert len(freed.records) == 40
    assert len(list(store(toys).records.all())) >= 12
    (toys.flags / "wait-total-210").unlink()
    _, err = process.communicate(timeout=60)
    assert process.returncode == 0, err
    toys.clear()
    assert toys.run().ran == set()


@pytest.mark.parametrize("asked", ["singles", "since", "listed"])
def test_what_a_run_under_way_records_during_a_collection_is_safe(toys, asked, monkeypatch):
    toys.run()
    there = store(toys)
    monkeypatch.setattr("kinetree.pipeline.storage.gc._latest", lambda runs: [{**run, "list": ""} for run in runs.values()])
    late, ask = replace(next(there.records.all()), key="ab" * 20), getattr(Records, asked)

    def answered(records, *arguments):
        answer = ask(records, *arguments)
        (toys.output / "store" / "records" / f"{late.key}.json").write_bytes(sealed(asdict(late)))
        return answer

    monkeypatch.setattr(Records, asked, answered)
    assert late.key not in collect(there).records
    monkeypatch.undo()
    assert store(toys).record(late.key) == late


@pytest.mark.parametrize("asked", ["singles", "since"])
def test_old_bytes_that_a_run_under_way_makes_again_during_a_collection_stay(toys, asked, monkeypatch):
    toys.run()
    there = store(toys)
    old = next(record for record in there.records.all() if record.task == "report")
    toys.run(intervals={"length": 3})
    for path in (toys.output / "store").rglob("*"):
        if path.is_file():
            os.utime(path, (time.time() - 60,) * 2)
    last = max(there.run_records.heads(), key=lambda run: run["epoch"])
    begun = {**last, "list": "", "epoch": time.time() - 10, "status": "running"}
    monkeypatch.setattr("kinetree.pipeline.storage.gc._latest", lambda runs: [begun])
    late, ask = replace(old, key="ab" * 20), getattr(Records, asked)

    def answered(records, *arguments):
        answer = ask(records, *arguments)
        (toys.output / "store" / "records" / f"{late.key}.json").write_bytes(sealed(asdict(late)))
        return answer

    monkeypatch.setattr(Records, asked, answered)
    garbage = collect(there, last=1)
    monkeypatch.undo()
    assert store(toys).record(late.key) == late
    assert store(toys).holds(late)
    assert late.artifact not in garbage.artifacts


def test_what_a_run_under_way_found_fresh_is_safe(toys):
    toys.run()
    toys.clear()
    toys.flag("wait-cones-60")
    process = toys.start("run", str(toys.yaml(intervals={"length": 3})), "--quiet")
    toys.until((toys.flags / "waiting-cones-60").exists, "cones begin", process)
    # the old run's own results go, what both use stays
    collect(store(toys), last=0)
    (toys.flags / "wait-cones-60").unlink()
    _, err = process.communicate(timeout=60)
    assert process.returncode == 0, err
    assert not [call for call in toys.executions() if call.startswith(("points", "smooth", "centred"))]
    assert toys.run().counts["intervals"] == 1


def test_work_of_a_killed_run_is_kept_until_a_later_one_has_taken_it_over(toys):
    toys.flag("wait-total-210")
    process = toys.start("run", str(toys.yaml()), "--quiet")
    toys.until((toys.flags / "waiting-total-210").exists, "total begins", process)
    os.killpg(process.pid, signal.SIGKILL)
    process.communicate()
    assert [run["status"] for run in toys.pipeline().runs()] == ["killed"]
    (toys.flags / "wait-total-210").unlink()
    assert collect(store(toys)).records == ()
    assert not {"points", "smooth"} & set(toys.run().counts)
    assert collect(store(toys)).records == ()
    assert toys.run().ran == set()


def test_half_written_leftovers_go_when_nobody_can_be_writing_them(toys):
    toys.run(until=("points",))
    leftover = toys.output / "store" / "tmp" / ".half"
    leftover.parent.mkdir(exist_ok=True)
    leftover.write_bytes(b"PK")
    assert collect(store(toys)).leftovers == ()
    os.utime(leftover, (1, 1))
    assert "tmp/.half" in collect(store(toys)).leftovers
    assert not leftover.exists()


@pytest.mark.parametrize(
    ("part", "is_refused"),
    [("nodes", False), ("artifacts", False), ("tmp", True), ("runs", True), ("packs", True), ("records", True)],
)
def test_what_a_link_in_the_store_leads_to_is_never_freed(toys, tmp_path, part, is_refused):
    toys.run()
    toys.run(intervals={"length": 3})
    folder, mine = toys.output / "store" / part, tmp_path / "mine"
    folder.mkdir(exist_ok=True)
    folder.rename(mine)
    folder.symlink_to(mine)
    (mine / "old" / "deep").mkdir(parents=True)
    for name in ("old/letter", "old/deep/letter.json", f"{'ab' * 20}.zip", f"{'ab' * 20}.json", "old.beat"):
        (mine / name).write_text("mine")
    for path in mine.rglob("*"):
        os.utime(path, (1, 1))
    before = {path: path.read_bytes() for path in mine.rglob("*") if path.is_file()}
    refused = pytest.raises(StoreError, match=f"'{part}/.*' does not lie in it, but behind a link")
    with refused if is_refused else contextlib.nullcontext():
        collect(store(toys))
    assert {path: path.read_bytes() for path in mine.rglob("*") if path.is_file()} == before


def test_a_store_that_is_a_link_is_collected_as_any_other(toys, tmp_path):
    toys.run()
    toys.run(intervals={"length": 3})
    (toys.output / "store").rename(tmp_path / "disk")
    (toys.output / "store").symlink_to(tmp_path / "disk")
    freed = collect(store(toys))
    assert freed.artifacts
    assert not set(freed.artifacts) & set(store(toys).artifacts())


def test_run_of_a_part_of_the_graph_does_not_give_the_rest_away(toys):
    toys.run()
    whole = {record.key for record in store(toys).records.all()}
    toys.run(until=["points"])
    toys.run(until=["smooth"])
    collect(store(toys))
    assert {record.key for record in store(toys).records.all()} == whole
    assert toys.run().ran == set()


def test_on_a_full_disk_a_collection_is_advised_only_where_it_frees_something(toys, monkeypatch):
    def advice():
        with pytest.raises(StoreFullError) as refused, advising(store(toys)):
            raise StoreFullError("no space left")
        return str(refused.value)

    monkeypatch.setattr(gc, "_WORTH_SAYING", 1)
    toys.run()
    assert advice() == "no space left"
    toys.run(points={"scale": 1.3})
    freed = collect(store(toys), dry=True).bytes
    assert advice() == f"no space left; kinetree gc would free {freed / 2**20:.1f} MiB of the store"
    collect(store(toys))
    assert advice() == "no space left"


def test_advice_needs_no_store(tmp_path):
    with pytest.raises(StoreFullError, match=r"^no space left$"), advising(Store.at(tmp_path / "none")):
        raise StoreFullError("no space left")
