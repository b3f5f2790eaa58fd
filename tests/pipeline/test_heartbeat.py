"""Which runs count as under way: a process is its number, its start and its machine; another machine is known by its beat."""

import os
import subprocess
import sys
import time

import pytest

from kinetree.pipeline.storage import heartbeat
from kinetree.pipeline.storage.gc import collect
from kinetree.pipeline.storage.heartbeat import beating, identity, lives
from kinetree.pipeline.storage.store import Store


@pytest.fixture
def store(tmp_path):
    created = Store.at(tmp_path / "store")
    created.create()
    return created


def run(**changes):
    return {"name": "one", "status": "running", "epoch": time.time(), **identity(), **changes}


def test_process_that_began_a_run_lives(store):
    assert lives(run(), store)


def test_process_that_ended_does_not_live_though_its_number_is_taken(store):
    with subprocess.Popen([sys.executable, "-c", "import sys; sys.stdin.read()"], stdin=subprocess.PIPE) as child:
        begun = heartbeat._start(child.pid)
        assert lives(run(pid=child.pid, process_start=begun), store)
        child.kill()
    assert not lives(run(pid=child.pid, process_start=begun), store)
    assert not lives(run(pid=os.getpid(), process_start=begun), store), "the number now belongs to another process"


def test_process_that_ended_unnoticed_by_its_parent_does_not_live(store):
    child = subprocess.Popen([sys.executable, "-c", "pass"])
    os.waitid(os.P_PID, child.pid, os.WEXITED | os.WNOWAIT)
    assert heartbeat._start(child.pid) is None
    child.wait()


def test_run_before_a_restart_of_the_machine_counts_as_another_machines(store):
    long_ago = time.time() - 2 * heartbeat.LOST_SECONDS
    assert not lives(run(machine="another boot", epoch=long_ago), store)


def test_run_on_another_machine_lives_while_its_heart_beats(store):
    far = run(machine="elsewhere", epoch=time.time() - 10 * heartbeat.LOST_SECONDS)
    assert not lives(far, store)
    store.place.put("runs/one.beat", b"alive")
    assert lives(far, store)
    long_ago = time.time() - 2 * heartbeat.LOST_SECONDS
    os.utime(store.place.root / "runs" / "one.beat", (long_ago, long_ago))
    assert not lives(far, store)


def test_beat_far_in_the_future_is_none(store):
    ahead = time.time() + 30 * 86400
    far = run(machine="elsewhere", epoch=ahead)
    assert not lives(far, store)
    store.place.put("runs/one.beat", b"alive")
    assert lives(far, store), "the other machine's clock is wrong, and it beats"
    os.utime(store.place.root / "runs" / "one.beat", (ahead, ahead))
    assert not lives(far, store)
    assert store.place.names("runs") == ["one.beat"]


def test_beat_by_the_clock_of_the_place_counts_though_this_machines_clock_is_behind(store, monkeypatch):
    far = run(machine="elsewhere")
    store.place.put("runs/one.beat", b"alive")
    behind = time.time() - 86400
    monkeypatch.setattr(time, "time", lambda: behind)
    assert lives(far, store)


def test_heart_beats_while_the_block_lasts_and_leaves_nothing(store, monkeypatch):
    monkeypatch.setattr(heartbeat, "BEAT_SECONDS", 0.001)
    with beating(store, "one"):
        while store.place.size("runs/one.beat") is None:
            time.sleep(0.001)
    assert store.place.names("runs") == []


def test_ghost_of_a_run_with_a_number_that_is_taken_does_not_keep_garbage(toys):
    """A run was killed, its number went to another process: its folder's next run has long taken over."""
    toys.run()
    store = Store.at(toys.output / "store")
    (done,) = store.run_names()
    ghost = {**store.run(done), "name": "20000101-000000-00000", "status": "running", "epoch": 0.0, "nodes": {}, "uses": []}
    store.write_run(ghost["name"], {**ghost, "process_start": ghost["process_start"] - 1})
    assert [r["status"] for r in toys.pipeline().runs()] == ["killed", "done"]
    toys.run(intervals={"length": 3})
    assert len(collect(store).records) == 1 + 3 + 3 + 6 + 1
