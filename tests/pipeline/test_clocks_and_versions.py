"""A clock that goes backwards, clocks of two machines that differ, and two versions of the code on one store."""

import time
from contextlib import contextmanager

import pytest

from kinetree.pipeline.planning import freshness
from kinetree.pipeline.running import execute
from kinetree.pipeline.storage.gc import collect
from kinetree.pipeline.storage.heartbeat import LOST_SECONDS, identity
from kinetree.pipeline.storage.store import Store


def under_way(toys, after, **changes):
    """Puts a run on record that began so many seconds after now, lives, and has made everything that the store holds."""
    toys.run()
    store = Store.at(toys.output / "store")
    for name in store.run_names():
        store.place.remove(f"runs/{name}.json")
    name = "20260101-000000-aaaaaa"
    run = {"name": name, "status": "running", "epoch": time.time() + after, "output": str(toys.output), "nodes": {}}
    run |= {**identity(), **changes}
    store.write_run(name, run)
    return store


@pytest.mark.parametrize("back", [0.0, 3600.0, 30 * 86400.0])
def test_what_a_run_under_way_made_after_the_clock_was_set_back_is_safe(toys, back):
    store = under_way(toys, back - 60.0)
    assert collect(store, last=0).artifacts == ()
    assert len(list(store.records.all())) == 40


def test_what_a_run_on_a_machine_with_a_clock_ahead_made_is_safe(toys):
    store = under_way(toys, 0.9 * LOST_SECONDS, machine="elsewhere")
    assert collect(store, last=0).artifacts == ()


def test_what_was_there_long_before_a_run_under_way_goes(toys):
    store = under_way(toys, 0.2)
    time.sleep(0.3)
    assert len(collect(store, last=0).records) == 40


def test_a_run_with_a_clock_that_was_set_back_finds_everything(toys, monkeypatch):
    toys.run()
    now = time.time()
    monkeypatch.setattr(time, "time", lambda: now - 86400.0)
    assert toys.run().ran == set()
    assert toys.run(intervals={"length": 3}).counts["intervals"] == 1
    monkeypatch.undo()
    assert toys.run(intervals={"length": 3}).ran == set()


@contextmanager
def version(monkeypatch, name):
    """The same tasks, as another version of the code would have them."""
    original = freshness.code_digest
    with monkeypatch.context() as patched:
        for module in (freshness, execute):
            patched.setattr(module, "code_digest", lambda *arguments: f"{name}{original(*arguments)}"[:40])
        yield


def test_two_versions_on_one_store_each_find_their_own_and_leave_the_others(toys, monkeypatch):
    assert len(toys.run().ran) > 0
    with version(monkeypatch, "b"):
        assert len(toys.run().ran) > 0
        assert toys.run().ran == set()
    assert toys.run().ran == set()
    with version(monkeypatch, "b"):
        assert toys.run().ran == set()
    assert toys.command("verify", str(toys.output)).returncode == 0
