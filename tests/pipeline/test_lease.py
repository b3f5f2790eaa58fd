"""A lease on a folder: one living process has it."""

import json
import os
import subprocess
import sys
import time

import pytest

from kinetree.errors import StoreError
from kinetree.pipeline.dataset.lease import LEASE, Leases, holder
from kinetree.pipeline.storage.heartbeat import LOST_SECONDS

TAKEN = """
import sys, pathlib
from kinetree.pipeline.dataset.lease import Leases
leases = Leases()
print(leases.take(pathlib.Path(sys.argv[1])), flush=True)
sys.stdin.read()
"""


@pytest.fixture
def other(tmp_path):
    """Starts a process that takes the lease and holds it until it is killed."""
    started = []

    def start():
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
        started.append(subprocess.Popen([sys.executable, "-c", TAKEN, str(tmp_path)], **pipes))
        return started[-1], started[-1].stdout.readline().strip()

    yield start
    for process in started:
        process.kill()
        process.communicate()


def elsewhere(folder, age):
    """A lease that a process of another machine touched so many seconds ago."""
    told = {"host": "far", "machine": "another", "pid": 1, "process_start": 1, "nonce": "x", "epoch": time.time() - age}
    (folder / LEASE).write_text(json.dumps(told))
    os.utime(folder / LEASE, (time.time() - age,) * 2)


def test_a_lease_is_taken_once_and_given_back(tmp_path):
    with Leases() as mine, Leases() as yours:
        assert mine.take(tmp_path / "a")
        assert not yours.take(tmp_path / "a")
        assert yours.take(tmp_path / "b")
        mine.give_back(tmp_path / "a")
        assert yours.take(tmp_path / "a")
    assert holder(tmp_path / "a") is None
    assert list((tmp_path / "a").iterdir()) == []


def test_another_process_has_it_until_it_dies(tmp_path, other):
    process, answer = other()
    assert answer == "True"
    with Leases() as mine:
        assert not mine.take(tmp_path)
        assert holder(tmp_path)["pid"] == process.pid
        process.kill()
        process.wait()
        assert holder(tmp_path) is None
        assert mine.take(tmp_path)
        assert other()[1] == "False"


def test_a_holder_on_another_machine_lives_while_it_touches_its_lease(tmp_path):
    elsewhere(tmp_path, age=LOST_SECONDS - 60)
    with Leases() as mine:
        assert not mine.take(tmp_path)
        assert holder(tmp_path)["host"] == "far"
        elsewhere(tmp_path, age=LOST_SECONDS + 60)
        assert mine.take(tmp_path)


def test_a_lease_touched_far_in_the_future_is_free(tmp_path):
    elsewhere(tmp_path, age=-LOST_SECONDS + 60)
    assert holder(tmp_path)["host"] == "far"
    elsewhere(tmp_path, age=-LOST_SECONDS - 60)
    assert holder(tmp_path) is None


def test_a_holder_touches_its_lease(tmp_path, monkeypatch):
    monkeypatch.setattr("kinetree.pipeline.dataset.lease.BEAT_SECONDS", 0.01)
    with Leases() as mine:
        mine.take(tmp_path)
        os.utime(tmp_path / LEASE, (0, 0))
        for _ in range(1000):
            if (tmp_path / LEASE).stat().st_mtime > 0:
                break
            time.sleep(0.01)
        assert (tmp_path / LEASE).stat().st_mtime > 0


@pytest.mark.parametrize("content", [b"", b"\xff\xfe", b"[1]", b"{}", b'{"epoch": 1', b'{"epoch": "x"}', b'{"epoch": [1]}'])
def test_what_is_no_lease_is_none(tmp_path, content):
    (tmp_path / LEASE).write_bytes(content)
    assert holder(tmp_path) is None
    with Leases() as mine:
        assert mine.take(tmp_path)


def test_a_lease_is_given_back_by_its_holder_alone(tmp_path):
    with Leases() as mine:
        mine.take(tmp_path)
        elsewhere(tmp_path, age=0)
    assert holder(tmp_path)["host"] == "far"


def test_a_folder_that_cannot_be_made_is_refused(tmp_path):
    (tmp_path / "file").write_text("")
    with Leases() as mine, pytest.raises(StoreError, match="cannot be written"):
        mine.take(tmp_path / "file" / "out")
