"""A worker whose store is not the run's is refused by name before it computes; what nobody sees is never called done."""

import socket
import threading

import pytest
from distributed import Client, LocalCluster

from kinetree.errors import StoreError
from kinetree.pipeline.running import sight as module
from kinetree.pipeline.running.sight import Sight
from kinetree.pipeline.storage.store import Store

ELSEWHERE = """
from pathlib import Path
from kinetree.pipeline.storage import place
original = place.Folder.__init__
def elsewhere(self, root, *rest, **named):
    original(self, Path(f"{root}-of-a-container"), *rest, **named)
place.Folder.__init__ = elsewhere
"""
"""As in a container: the same path, another folder; what is written there nobody else sees."""
OVERLAY = """
from kinetree.pipeline.storage import place
original = place.Folder.put
def beside(self, path, data):
    if "sight" in path:
        original(self, "tmp/overlay/" + path, data)
    else:
        original(self, path, data)
place.Folder.put = beside
"""
"""What the run wrote can be read, what the worker writes goes elsewhere."""
FORGETFUL = """
from kinetree.pipeline.storage import store
store.Store.write = lambda self, record: None
"""
"""The worker's records never reach the store."""


@pytest.fixture
def client(toys):
    """A worker of somebody else's cluster, in a process of its own."""
    options = {"n_workers": 1, "threads_per_worker": 1, "processes": True, "dashboard_address": "127.0.0.1:0"}
    with LocalCluster(**options) as cluster, Client(cluster) as found:
        yield found


@pytest.mark.parametrize(
    ("mount", "problem"),
    [(ELSEWHERE, "what the run wrote there is not there"), (OVERLAY, "what the worker wrote there is not there for the run")],
)
def test_a_worker_with_another_store_is_refused_by_host_and_path_before_it_computes(toys, client, mount, problem, monkeypatch):
    monkeypatch.setattr(module, "SEEN_WITHIN", 0.5)
    client.run(exec, mount, {})
    with pytest.raises(StoreError) as refused:
        toys.run(client)
    place = f"worker on {socket.gethostname()}: {toys.output / 'store'}"
    assert str(refused.value).startswith(f"{place} is not the store of this run")
    assert problem in str(refused.value)
    assert toys.executions() == []
    assert [run["status"] for run in toys.pipeline().runs()] == ["stopped"]


def test_a_node_whose_record_nobody_sees_is_not_done(toys, client, monkeypatch):
    monkeypatch.setattr(module, "SEEN_WITHIN", 0.3)
    client.run(exec, FORGETFUL, {})
    with pytest.raises(StoreError, match=rf"points\[frame=\d\]: {socket.gethostname()} computed it, but its record"):
        toys.run(client)
    assert toys.pipeline().runs()[0]["counts"]["ran"] == 0


def test_a_worker_that_joins_later_proves_itself_too(toys, client, tmp_path):
    toys.run(store=str(tmp_path / "calm"))
    toys.clear()
    flag = toys.flag("wait-total-210")
    process = toys.start("run", str(toys.yaml()), "--scheduler", client.scheduler.address, "--quiet")
    toys.until((toys.flags / "waiting-total-210").exists, "total begins", process)
    client.cluster.scale(2)
    client.wait_for_workers(2)
    flag.unlink()
    _, err = process.communicate(timeout=60)
    assert (process.returncode, err) == (0, "")
    assert toys.artifacts() == toys.artifacts(store=str(tmp_path / "calm"))


def test_a_run_leaves_nothing_of_the_proof_behind(toys):
    toys.run()
    assert list((toys.output / "store" / "tmp").iterdir()) == []


def test_a_process_proves_itself_once(tmp_path, monkeypatch):
    store = Store.at(tmp_path)
    sight = Sight.of(store)
    sight.prove(str(tmp_path / "anywhere"))  # the run's own process needs no proof
    monkeypatch.setattr(module, "_proven", set())
    worker = threading.Thread(target=sight.prove, args=[store.url])
    worker.start()
    while worker.is_alive():
        sight.confirm(store)
    assert module._proven == {sight.folder}


def test_a_folder_with_other_things_is_no_store_of_the_run(tmp_path, monkeypatch):
    sight = Sight.of(Store.at(tmp_path / "store"))
    monkeypatch.setattr(module, "_proven", set())
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "notes.txt").write_text("mine")
    with pytest.raises(StoreError, match=r"is not the store of this run \(store .*this folder holds other things"):
        sight.prove(str(tmp_path / "other"))
